#pragma once

#include <array>
#include <span>

#include "contacts/contacts.h"
#include "core/result.h"
#include "math/transform.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Where a foot stands on the ground, told from the pose of its foot joint alone, whether the foot
// is flat, comes down on its heel or on its ball.

namespace krok::parametric {

// What the sole is in the frame of the foot joint (at the ankle).
struct FootShape {
  int joint = -1;
  Vec3 heel = Vec3::Zero();      // the heel's point of the sole, metres
  Vec3 forward = Vec3::UnitZ();  // along the sole, unit
  double length = 0;             // from the heel to the ball, metres; 0 where the ball is not known
};

// A place on the ground and the direction that the toes point to.
struct Footprint {
  Vec3 place = Vec3::Zero();  // of the heel, metres
  double heading = 0;         // about +Y: 0 faces +Z, a quarter turn +X

  // From the footprint's frame (origin at the heel, toes to +Z) to that of `place`.
  Transform to_world() const;
};

// The sole's ball in the foot joint's frame.
Vec3 ball_of(const FootShape& foot);

// The footprint as it is once the foot has rolled flat: a foot with its heel lower than its ball
// turns about the heel, which is where it stands; one with its ball lower turns about the ball, so
// that the heel comes down its length behind. Feet of a pitch of either sign are told alike, and
// there is no jump from one to the other. The heading is the level direction of the sole; 0 where
// the foot stands on its tips within 0.001 of upright.
Footprint footprint(const FootShape& foot, const Transform& foot_to_world);

// The soles of a figure, [FootSide]. Heels and balls are where find_feet() has them, the medians
// over the clips; which way is forward in the foot's frame is read off the frames in which heel and
// ball of a foot stay, for then it is flat, otherwise off the reference pose. Clips that
// climb count only where all do, for on a slope a flat foot is tilted. Clips of one skeleton, at
// least one. Code: parametric-feet where roles know no feet.
struct ClipContacts {
  const Clip* clip = nullptr;
  const FoundContacts* contacts = nullptr;  // may be null
};
Result<std::array<FootShape, 2>> find_foot_shapes(std::span<const ClipContacts> clips,
                                                  const RoleMap& roles);

}  // namespace krok::parametric
