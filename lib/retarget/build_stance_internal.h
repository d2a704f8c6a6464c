#pragma once

#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok::retarget {

// A T-pose of a humanoid whose reference pose does not stand (rigs whose bones all lie along one
// axis), shape [joints], facing +Z: legs down, arms to the sides, soles on the ground. It belongs
// to the skeleton and not to a motion of it: bones are turned by their directions, the turn about a
// bone by the side on which knees and elbows bend in the whole motion. Spine, head, hands and feet
// are turned as in the reference pose, or by the quarter turns from it that are nearest to the
// motion's mean. Only bone lengths and the pitch of the feet on the ground are measured. Joints
// whose roles are missing keep their place. Without `limbs` the body is only turned upright as a
// whole. Where a motion begins with a T-pose, as some exporters have it, that is the stance.
std::vector<Transform> build_stance(const Clip& clip, const RoleMap& roles, bool limbs);

// Whether limbs are straight in the first frame, legs down and arms to the sides.
bool begins_in_a_stance(const Clip& clip, const RoleMap& roles);

}  // namespace krok::retarget
