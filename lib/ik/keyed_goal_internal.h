#pragma once

#include <span>
#include <vector>

#include "ik/goal_motion.h"
#include "math/transform.h"
#include "scene/skeleton.h"

namespace krok::ik {

// Whether a goal can be placed in motions of the skeleton; codes as apply_goals().
Status check_goal(const KeyedGoal& goal, const Skeleton& skeleton);

// The goal at a time, with its keys in `frame`, on the support joints of a pose.
Goal placed(const KeyedGoal& keyed, double time, const Transform& frame,
            std::span<const Transform> pose);

// Seconds between which a goal has its full strength.
struct FullStrength {
  double from = 0, to = 0;
};
FullStrength full_strength(const KeyedGoal& goal, double duration, double rate);

// Moves a goal's target towards what the pose does without it: strength 0 asks for the pose as it
// is, 1 for the goal.
void fade_goal(Goal& goal, double strength, const Skeleton& skeleton,
               const std::vector<Transform>& pose);

}  // namespace krok::ik
