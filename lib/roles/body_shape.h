#pragma once

#include <optional>
#include <vector>

#include "roles/joint_names.h"
#include "scene/skeleton.h"

namespace krok {

// Part and side of each joint, shape [joints], derived from the reference pose alone, for skeletons
// without meaningful names. Requires a trunk between two mirrored pairs of limbs, an upright pose
// with the hands above the ground (unlike the front feet of quadrupeds), a branch for the head, and
// feet that show the facing direction, which determines left and right. Empty otherwise.
std::optional<std::vector<JointName>> names_from_shape(const Skeleton& skeleton);

}  // namespace krok
