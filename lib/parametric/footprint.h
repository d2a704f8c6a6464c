#pragma once

#include <array>
#include <span>
#include <vector>

#include "contacts/contacts.h"
#include "core/result.h"
#include "math/transform.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Footprint of a foot on the ground, from the pose of its foot joint alone, whether the foot is
// flat, on its heel or on its ball.

namespace krok::parametric {

// Sole geometry in the frame of the foot joint (ankle).
struct FootShape {
  int joint = -1;
  Vec3 heel = Vec3::Zero();      // of the sole, metres
  Vec3 forward = Vec3::UnitZ();  // along the sole, unit vector
  double length = 0;             // from heel to ball, metres; 0 if the ball is not known
  // Mean heading of the sole relative to the direction of travel, radians about +Y: positive for a
  // left foot and negative for a right foot whose toes point outward.
  double toe_out = 0;
};

// Position on the ground and direction of the toes.
struct Footprint {
  Vec3 place = Vec3::Zero();  // of the heel, metres
  double heading = 0;         // about +Y: 0 faces +Z, a quarter turn faces +X

  // From the footprint's frame (origin at the heel, toes to +Z) to the frame of `place`.
  Transform to_world() const;
};

// The ball of the foot, in the frame of the foot joint.
Vec3 ball_of(const FootShape& foot);

// The footprint after the foot has rolled flat: if the heel is lower than the ball, the foot
// rotates about the heel; if the ball is lower, about the ball, so that the heel lands one sole
// length behind it. Continuous in pitch. The heading is the horizontal direction of the sole; 0 if
// the sole is within 0.001 of vertical.
Footprint footprint(const FootShape& foot, const Transform& foot_to_world);

// Sole geometry of both feet, [FootSide]. Heels and balls are those of find_feet(), as medians over
// the clips. The forward direction comes from frames in which both heel and ball are in contact,
// since the foot is flat then, otherwise from the reference pose. Clips that climb are used only if
// all do, because a flat foot is tilted on a slope. All clips share one skeleton; at least one is
// needed. Code: parametric-feet if `roles` have no feet.
struct ClipContacts {
  const Clip* clip = nullptr;
  const FoundContacts* contacts = nullptr;  // may be null
};
Result<std::array<FootShape, 2>> find_foot_shapes(std::span<const ClipContacts> clips,
                                                  const RoleMap& roles);

// One footprint of a walk, in the order of strikes.
struct WalkPrint {
  FootSide side = FootSide::left;
  Footprint print;
};

// Mean toe_out of both feet, [FootSide], radians, over walks: the direction of travel at a
// footprint is that from the other foot's footprint before to the one after, which holds on a curve
// as well. 0 for both if there are fewer than three such footprints of either foot, with steps of
// over 0.1 m.
std::array<double, 2> toe_out_of(std::span<const std::vector<WalkPrint>> walks);

}  // namespace krok::parametric
