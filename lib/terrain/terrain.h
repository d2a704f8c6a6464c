#pragma once

#include <limits>
#include <optional>

#include "math/transform.h"

// The ground: what a walker stands on.

namespace krok {

// A point of a surface that can be stood on.
struct GroundPoint {
  double height = 0;            // metres, +Y
  Vec3 normal = Vec3::UnitY();  // unit vector, normal.y() > 0
};

// A surface over the ground plane (x, z), metres, world space. There may be several surfaces above
// one another (a bridge), none (a hole, beyond the edge), and edges where the height jumps
// (stairs). Immutable, so that threads may share it.
class Terrain {
 public:
  virtual ~Terrain() = default;

  // The highest surface at (x, z) that is not above `below` metres; empty if there is none, and for
  // values that are not finite.
  virtual std::optional<GroundPoint> at(
      double x, double z, double below = std::numeric_limits<double>::infinity()) const = 0;

  // Whether something solid, which need not be ground, is between two points: a wall, a railing.
  // Kinds whose surfaces are heights over (x, z) have nothing else and answer no.
  virtual bool is_blocked(const Vec3& /*from*/, const Vec3& /*to*/) const { return false; }
};

}  // namespace krok
