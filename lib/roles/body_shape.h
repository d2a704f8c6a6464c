#pragma once

#include <optional>
#include <vector>

#include "roles/joint_names.h"
#include "scene/skeleton.h"

namespace krok {

// The words that a person's joints would have, shape [joints], worked out from the reference pose
// alone, for skeletons whose names tell nothing. Only where it is safe: a trunk between two
// mirrored pairs of limbs, standing upright with the hands clear of the ground (which four-legged
// animals' front feet are not), a branch for the head, and feet that show where the figure faces,
// for left and right follow from it. Nothing otherwise.
std::optional<std::vector<JointName>> names_from_shape(const Skeleton& skeleton);

}  // namespace krok
