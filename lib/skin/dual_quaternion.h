#pragma once

#include "math/transform.h"
#include "skin/palette.h"

namespace krok {

// A rigid motion x -> q x q* + t as the unit dual quaternion q + e/2 t q, in floats for the
// kernels: x, y, z, w of q, then of t q / 2. Both parts negated are the same motion. Source:
// Kavan, Collins, Zara, O'Sullivan, Geometric Skinning with Approximate Dual Quaternion Blending
// (ACM Transactions on Graphics 27(4), 2008).
struct alignas(32) DualQuaternion {
  float components[8];
};

DualQuaternion dual_quaternion(const Transform& transform);

// Whether the linear part of a palette's matrix is a rotation to within 1e-5 in each element of
// A^T A; a matrix with a mirroring is none, nor is one with a NaN.
bool is_rigid(const SkinMatrix& matrix);

// A matrix as a rigid motion after a part that scales, shears and perhaps mirrors: the two phases
// of Kavan et al., section 4.2.
struct SplitMatrix {
  DualQuaternion motion;
  SkinMatrix deformation;
};

// Splits `matrix` by the polar decomposition A = R S of its linear part. The deformation S leaves
// `centre` (the joint in the reference pose, metres) in its place, so that blending motions of
// several joints does not pick up what scaling alone moves far from the joint. R is always a
// rotation; what mirrors goes into S. A rigid matrix has the identity exactly for its deformation,
// one that is not finite the identity for R.
SplitMatrix split(const SkinMatrix& matrix, const Vec3& centre);

}  // namespace krok
