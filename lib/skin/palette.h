#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "scene/skeleton.h"

namespace krok {

// The map of one joint that skinning applies to vertices of the reference mesh: M_j C_j^-1, as
// floats for the kernels. Column-major, column c at elements[4 * c], the last row is 0 0 0 1.
struct alignas(64) SkinMatrix {
  float elements[16];
};

// The part of the palette that does not change over time, C_j^-1 of each joint: reference_to_joint,
// shape [joints].
std::vector<Transform> inverse_reference(const Skeleton& skeleton);

// palette[j] = joint_to_world[j] * reference_to_joint[j], worked out in doubles and rounded once.
// All spans have [joints] elements. In the reference pose each matrix is the identity to within the
// rounding of floats. Source: Lewis, Cordner, Fong, Pose Space Deformation (SIGGRAPH 2000), sec. 2.
void make_palette(std::span<const Transform> reference_to_joint,
                  std::span<const Transform> joint_to_world, std::span<SkinMatrix> palette);

}  // namespace krok
