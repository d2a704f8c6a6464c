#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "scene/skeleton.h"
#include "scene/stretch.h"

namespace krok {

// The skinning matrix of one joint, M_j C_j^-1, applied to vertices of the reference mesh; floats
// for the kernels. Column-major, column c at elements[4 * c], the last row is 0 0 0 1.
struct alignas(64) SkinMatrix {
  float elements[16];
};

// The inverse bind transforms C_j^-1: reference_to_joint, shape [joints].
std::vector<Transform> inverse_reference(const Skeleton& skeleton);

// palette[j] = joint_to_world[j] * reference_to_joint[j], computed in double and rounded once. All
// spans have [joints] elements. In the reference pose each matrix is the identity to within float
// rounding. Source: Lewis, Cordner, Fong, Pose Space Deformation (SIGGRAPH 2000), sec. 2.
void make_palette(std::span<const Transform> reference_to_joint,
                  std::span<const Transform> joint_to_world, std::span<SkinMatrix> palette);

// The palette matrix of one joint that is stretched, [R U | p] C^-1.
SkinMatrix skin_matrix(const Transform& reference_to_joint, const Transform& joint_to_world,
                       const Stretch& stretch);

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
