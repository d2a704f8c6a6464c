#pragma once

#include <vector>

#include "ik/goal.h"
#include "scene/skeleton.h"

namespace krok::ik {

// Moves a goal's target towards what the pose does without it: strength 0 asks for the pose as it
// is, 1 for the goal.
void fade_goal(Goal& goal, double strength, const Skeleton& skeleton,
               const std::vector<Transform>& joint_to_world);

}  // namespace krok::ik
