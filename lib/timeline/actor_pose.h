#pragma once

#include <span>
#include <vector>

#include "motion/ground_frame.h"
#include "scene/skeleton.h"

// A pose taken apart: where the figure stands and faces, and its joints as seen from there.

namespace krok::timeline {

struct ActorPose {
  GroundFrame place;
  std::vector<Transform> local;  // joint_to_parent; the root's to the place
};

ActorPose actor_pose(const Skeleton& skeleton, int carrier,
                     std::span<const Transform> joint_to_world);
void to_world(const Skeleton& skeleton, const ActorPose& pose, std::span<Transform> joint_to_world);

// Places as the transforms of the ground that they are: `second` in the frame of `first`.
GroundFrame combined(const GroundFrame& first, const GroundFrame& second);
GroundFrame inverse(const GroundFrame& place);

// x, z, heading. The difference of headings is the shorter way round.
Vec3 as_vector(const GroundFrame& place);
Vec3 difference(const GroundFrame& from, const GroundFrame& to);
GroundFrame moved(const GroundFrame& place, const Vec3& by);

}  // namespace krok::timeline
