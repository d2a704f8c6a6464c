#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ik/goal_motion.h"
#include "roles/roles.h"
#include "scene/clip.h"

// What stays in place, and what is shifted, where goals move a whole body: for
// GoalMotionOptions::held and Options::moving_joint. Places are in metres, y is up; joints of goals
// must exist. `clip` is the motion or a part of it.

namespace krok::ik {

// 1 for joints that goals are for, and for what hangs on them; balance is for none. [joints]
std::vector<std::uint8_t> sought_by(std::span<const KeyedGoal> goals, const Skeleton& skeleton);

// A humanoid's legs that no goal is for; `clip` shows how their knees bend.
std::vector<HeldFoot> legs_without_goals(const Clip& clip, const RoleMap& roles,
                                         std::span<const KeyedGoal> goals);

// Of a skeleton without legs that have roles: what ends within a tenth of the skeleton's size over
// the lowest place of `clip` and hangs on no goal's joint, nor beside it as a finger beside
// another, each as a foot without a leg.
std::vector<HeldFoot> ends_on_ground(const Clip& clip, std::span<const KeyedGoal> goals);

// The joint to shift: where legs and trunk part, or what carries that joint at hardly any distance
// (a tenth of a thigh). Without legs the root, or the joint below it that is apart from the ends on
// the ground.
int moving_joint(const Clip& clip, const RoleMap& roles, std::span<const KeyedGoal> goals);

}  // namespace krok::ik
