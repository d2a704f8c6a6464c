#pragma once

#include <span>
#include <vector>

#include "motion/ground_place.h"
#include "scene/skeleton.h"

// A pose taken apart: where the figure stands and faces, and its joints as seen from there.

namespace krok::timeline {

struct FigurePose {
  GroundPlace place;
  std::vector<Transform> local;  // joint_to_parent; the root's to the place
};

FigurePose figure_pose(const Skeleton& skeleton, int carrier,
                       std::span<const Transform> joint_to_world);
void to_world(const Skeleton& skeleton, const FigurePose& pose,
              std::span<Transform> joint_to_world);

// Places as the transforms of the ground that they are: `second` in the frame of `first`.
GroundPlace combined(const GroundPlace& first, const GroundPlace& second);
GroundPlace inverse(const GroundPlace& place);

// x, z, heading. The difference of headings is the shorter way round.
Vec3 as_vector(const GroundPlace& place);
Vec3 difference(const GroundPlace& from, const GroundPlace& to);
GroundPlace moved(const GroundPlace& place, const Vec3& by);

}  // namespace krok::timeline
