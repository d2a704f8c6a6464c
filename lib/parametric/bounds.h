#pragma once

#include <span>
#include <vector>

#include "parametric/library.h"

// The range of parameters that a library can be asked for.

namespace krok::parametric {

// The convex hull of the examples, each parameter scaled by its range, widened by `margin`. A
// bounding box would allow too much: with long steps on level ground and short ones on stairs, it
// includes long steps on stairs, for which there is no data. The margin allows for measured
// parameters that miss an intended grid slightly.
struct Bounds {
  int dimensions = 0;
  std::vector<double> lower, upper;  // [d], the range of the examples, in parameter units
  std::vector<double> points;        // [examples x d], scaled to [0, 1]
  double margin = 0.02;              // of the range

  // Scales p by the ranges; a range under 1e-9 counts as 1.
  void scale(std::span<const double> point, std::span<double> scaled) const;
};

// The library needs at least one example.
Bounds bounds_of(const Library& library);

// How far outside a point is, in ranges (0: inside, margin included), and the nearest point inside,
// in scaled parameters. Uses Wolfe's algorithm (Finding the nearest point in a polytope, Math.
// Programming 11, 1976). NaN or infinite parameters are infinitely far outside; `nearest` is then
// the mean of the examples.
struct Outside {
  double distance = 0;
  std::vector<double> nearest;  // [d], in parameter units; the point itself if it is inside
};
Outside outside(const Bounds& bounds, std::span<const double> point);

}  // namespace krok::parametric
