#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "gait/print.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "terrain/terrain.h"

// Footprints under a motion that is there already: where they lie, and when a foot stands on each.

namespace krok::gait {

struct FootSize {
  double leg = 0.85;     // metres, hip to ankle
  double ball = 0.19;    // metres, from heel to ball
  double length = 0.26;  // metres, from heel to the tip of the toes
};

// The height of a ground below a point, or just above it, in metres; empty where there is none. The
// ground must outlive it.
std::function<std::optional<double>(const Vec3&)> height_of(const Terrain& ground);

// Which way a ground faces below a point, or just above it, for find_feet(); upwards where there is
// none. The ground must outlive it.
UpOfGround up_of(const Terrain& ground);

// Of a skeleton's feet, the mean of both; that of a man of 1.73 m where it has none.
FootSize foot_size(const Clip& clip, const RoleMap& roles);

// Where the prints lie, as walk() sets them on the ground: each on the storey that is nearest to
// the one before. Times are not set. Codes walk-ground, walk-too-high and walk-too-steep, with the
// number of the print, counted from 1.
Result<std::vector<GroundedPrint>> set_on_ground(std::span<const Print> prints,
                                                 const FootSize& size, const Terrain& ground);

// An interval in which a foot stands on a print.
struct PrintContact {
  int print = 0;              // index
  double start = 0, end = 0;  // seconds from the first frame to the last in which it does
};

// When the feet of a motion stand on the prints: in the frames in which the heel is within `near`
// metres of a print's heel, or the ball of its ball. By print, then by time. Empty for a skeleton
// without feet.
std::vector<PrintContact> contacts_with_prints(const Clip& clip, const RoleMap& roles,
                                               std::span<const GroundedPrint> prints,
                                               const FootSize& size, const Terrain& ground,
                                               double near = 0.025);

}  // namespace krok::gait
