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

}  // namespace krok
