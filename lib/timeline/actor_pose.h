#pragma once

#include <span>
#include <vector>

#include "motion/ground_frame.h"
#include "scene/skeleton.h"

// A pose split into the actor's ground frame (position and heading) and joints relative to it.

namespace krok::timeline {

struct ActorPose {
  GroundFrame place;
  std::vector<Transform> local;  // joint_to_parent; the root is relative to the ground frame
};

ActorPose actor_pose(const Skeleton& skeleton, int carrier,
                     std::span<const Transform> joint_to_world);
void to_world(const Skeleton& skeleton, const ActorPose& pose, std::span<Transform> joint_to_world);

// Composition and inverse as 2D transforms: `second` is given in the frame of `first`.
GroundFrame combined(const GroundFrame& first, const GroundFrame& second);
GroundFrame inverse(const GroundFrame& place);

// x, z, heading. difference() wraps the heading to half a turn.
Vec3 as_vector(const GroundFrame& place);
Vec3 difference(const GroundFrame& from, const GroundFrame& to);
GroundFrame moved(const GroundFrame& place, const Vec3& by);

}  // namespace krok::timeline
