#pragma once

#include <cstdint>
#include <vector>

#include "contacts/legs.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"

// The joints that foot clean-up moves. Used by plant_feet().

namespace krok::plant {

// The part of the body that a joint moves with.
enum class Body : std::uint8_t { none, pelvis, upper, lower, foot, toes };

struct Leg : LegJoints {
  FootSide side = FootSide::left;
  std::vector<SolePoint> points = {};  // heel before ball before tip
  Vec3 knee_axis =
      Vec3::Zero();  // the usual direction of cross(thigh, shank), in the thigh's frame

  const SolePoint* point(FootPart part) const { return point_of(points, part); }
};

struct PlantedBody {
  std::vector<Leg> legs;           // one or two
  int pelvis = 0;                  // all joints below it move with it
  double leg_length = 0;           // metres
  std::vector<Body> bodies;        // [joints]
  std::vector<std::uint8_t> side;  // [joints], index into legs, for joints of legs
};

// Code contacts-feet where no leg has thigh, shank and foot.
Result<PlantedBody> find_body(const Clip& clip, const RoleMap& roles);

}  // namespace krok::plant
