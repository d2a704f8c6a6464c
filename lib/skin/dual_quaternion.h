#pragma once

#include "math/transform.h"
#include "skin/palette.h"

namespace krok {

// A rigid transform x -> q x q* + t as the unit dual quaternion q + e/2 t q, in floats for the
// kernels: x, y, z, w of q, then of t q / 2. Negating both parts gives the same transform. Source:
// Kavan, Collins, Zara, O'Sullivan, Geometric Skinning with Approximate Dual Quaternion Blending
// (ACM Transactions on Graphics 27(4), 2008).
struct alignas(32) DualQuaternion {
  float components[8];
};

DualQuaternion dual_quaternion(const Transform& transform);

// Whether the linear part A of a palette matrix is a rotation to within 1e-5 in each element of
// A^T A; false for reflections and NaN.
bool is_rigid(const SkinMatrix& matrix);

// A matrix as a deformation (scale, shear, reflection) followed by a rigid transform: the two
// phases of Kavan et al., section 4.2.
struct SplitMatrix {
  DualQuaternion motion;
  SkinMatrix deformation;
};

// Splits `matrix` by the polar decomposition A = R S of its linear part. The deformation S keeps
// `centre` (the joint in the reference pose, metres) fixed, so that scaling adds no translation to
// the blended rigid transforms. R is always a rotation; reflections go into S. For a rigid matrix
// the deformation is exactly the identity; for one that is not finite R is the identity.
SplitMatrix split(const SkinMatrix& matrix, const Vec3& centre);

}  // namespace krok
