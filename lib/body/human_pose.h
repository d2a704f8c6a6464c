#pragma once

#include <span>
#include <vector>

#include "body/human_actor.h"

namespace krok::body {

// A pose suitable for human_shape, derived from an arbitrary pose.
struct StandingPose {
  std::vector<Transform> joint_to_world;
  double turned = 0;   // radians, sum of all bone rotations; 0: the pose is unchanged
  double heading = 0;  // radians, rotation of the whole body to stand upright facing +Z
};

// Rotates only what prevents building a body: the whole body upright and facing +Z, arms away from
// the trunk (about 30 to 100 degrees from hanging straight down), elbows, wrists, knees and toes
// bent by more than about 25 degrees straight, legs side by side under the hips, feet level and
// forward, a folded trunk or neck up. Corrections apply to both sides. Bone lengths are kept. Limbs
// are rotated by the shortest arc, so that they keep their twist.
StandingPose stand_upright(const Skeleton& skeleton, const HumanActor& actor,
                           std::span<const Transform> pose);

}  // namespace krok::body
