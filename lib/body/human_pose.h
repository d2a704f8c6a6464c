#pragma once

#include <span>
#include <vector>

#include "body/human_actor.h"

namespace krok::body {

// A pose that human_shape can build a body in, made from one that it may not be able to.
struct StandingPose {
  std::vector<Transform> joint_to_world;
  double turned = 0;   // radians, how far bones were turned, all added up; 0: the pose as it was
  double heading = 0;  // radians, how far the whole figure was turned to stand upright facing +Z
};

// Turns what stands in the way of a body, and nothing else: the whole figure upright and facing +Z,
// arms away from the trunk (some 30 to 100 degrees from hanging straight down), elbows, wrists,
// knees and toes that are bent by more than some 25 degrees straight, legs side by side under the
// hips, feet level and forward, a folded trunk or neck up. What one side needs, both get. Bones
// keep their lengths. Limbs are turned by the shortest way, so that they keep their twist.
StandingPose stand_upright(const Skeleton& skeleton, const HumanActor& actor,
                           std::span<const Transform> pose);

}  // namespace krok::body
