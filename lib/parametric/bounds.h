#pragma once

#include <span>
#include <vector>

#include "parametric/library.h"

// Which parameters a library can be asked for.

namespace krok::parametric {

// Inside is what lies between the examples: their convex hull, each parameter scaled by its range,
// widened by `margin` all round. A box of ranges would promise more: with long steps on the level
// and short ones on stairs it holds long steps on stairs, of which nothing is known. Examples that
// were meant to lie on a grid miss it by a little when they are measured, hence the margin.
struct Bounds {
  int dimensions = 0;
  std::vector<double> lower, upper;  // [d], the examples' own range, in the parameters' units
  std::vector<double> points;        // [examples x d], scaled to [0, 1]
  double margin = 0.02;              // of the range

  // p scaled by the ranges; a range of nothing (under 1e-9) counts as 1.
  void scale(std::span<const double> point, std::span<double> scaled) const;
};

// The library has one example or more.
Bounds bounds_of(const Library& library);

// How far outside a point is, in ranges (0: inside, margin included), and the point inside that is
// nearest in scaled parameters. Wolfe's algorithm for the point of a polytope nearest to another
// (Finding the nearest point in a polytope, Math. Programming 11, 1976). Parameters that are no
// numbers are infinitely far outside; `nearest` is then the middle of the examples.
struct Outside {
  double distance = 0;
  std::vector<double>
      nearest;  // [d], in the parameters' units; the point itself where it is inside
};
Outside outside(const Bounds& bounds, std::span<const double> point);

}  // namespace krok::parametric
