#pragma once

#include <span>

#include "contacts/sole_points.h"

// Legs and their points, as all that finds contacts, plants feet or walks on footprints uses them.

namespace krok {

// The joints of a leg, -1 where it has none.
struct LegJoints {
  int upper = -1, lower = -1, foot = -1;
  int toes = -1;  // the joint at the ball
};

// By their roles; the first joint of the toes.
LegJoints leg_joints(const RoleMap& roles, FootSide side);

// Whether `joint` is `ancestor` or one of its descendants.
bool is_below(const Skeleton& skeleton, int joint, int ancestor);

// The point of that part, or null.
const SolePoint* point_of(std::span<const SolePoint> points, FootPart part);

// joint_to_world of one joint in one frame, the orientation a unit quaternion.
inline Transform joint_at(const Clip& clip, int frame, int joint) {
  const auto j = static_cast<std::size_t>(joint);
  return {clip.frame_positions(frame)[j].cast<double>(),
          clip.frame_orientations(frame)[j].cast<double>().normalized()};
}

// The widths of two actors' hips.

// Metres by which each foot of an actor is to be farther to its side than that of the actor it
// follows, so that it is as far from its hip: half of what the hips are wider, negative for
// narrower ones. 0 where they differ as those of people do, and as rigs place hip joints: by less
// than 0.06 of the leg on each side; all of it from 0.12. Widths are from hip joint to hip joint,
// `leg` is that of the actor, `other_width` that of the other, in the same scale; metres.
double beside_for_hips(double width, double other_width, double leg);

}  // namespace krok
