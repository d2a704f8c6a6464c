#pragma once

#include <vector>

#include "terrain/surface.h"

// The lines on which a ground is sampled. Used by surface_of().

namespace krok::terrain {

// Where along X and Z a ground is to be sampled so that what is linear between the lines misses it
// by no more than about `tolerance`. A jump has a line on either side, closer than kJump.
struct SurfaceLines {
  std::vector<double> x, z;  // rising, at least two
};

inline constexpr double kJump = 2e-6;  // metres

SurfaceLines surface_lines(const Terrain& ground, const SurfaceOptions& options, double tolerance);

}  // namespace krok::terrain
