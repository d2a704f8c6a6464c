#pragma once

#include <optional>

#include "contacts/sole_points.h"
#include "math/transform.h"

// Footprints of a walk: where each foot is set, in order.

namespace krok::gait {

// A footprint that is asked for.
struct Print {
  FootSide side = FootSide::left;
  double x = 0, z = 0;           // of the heel, metres, world
  double heading = 0;            // of the toes, radians about +Y: 0 faces +Z, a quarter turn +X
  std::optional<double> height;  // of the heel, metres; empty: the ground's
  std::optional<double> time;  // of the strike, seconds from the first frame; empty: the library's
};

// A footprint on the ground: the line from heel to ball of a flat foot, and which way its sole
// faces: in the plane nearest to the ground under its corners.
struct GroundedPrint {
  FootSide side = FootSide::left;
  Vec3 heel = Vec3::Zero();      // metres, world; on the ground
  Vec3 forward = Vec3::UnitZ();  // from heel to ball, unit vector
  Vec3 up = Vec3::UnitY();       // normal of the sole, unit vector, perpendicular to `forward`
  double heading = 0;            // radians, of `forward`
  double facing = 0;             // radians, of the body above it: toes turn out from it
  double strike = 0;             // seconds; 0 for the two prints the walk starts on
  double off = 0;                // seconds, when the toes leave it; the end for the last two
};

}  // namespace krok::gait
