#pragma once

#include <span>
#include <vector>

#include "math/transform.h"

// What stands for several values: medians of points, extremes and means of a window over a series.

namespace krok {

// The largest value within `reach` (>= 0) values on either side, of each.
std::vector<double> max_within(std::span<const double> values, int reach);

// A smooth curve that is nowhere below `values` (within rounding): the max over `reach` (>= 0)
// neighbours on either side, averaged over as many with raised-cosine weights.
std::vector<double> softened(std::span<const double> values, int reach);
// The same, but empty where all values are 0.
std::vector<double> softened_if_any(std::vector<double> values, int reach);

// The mean of so many values; the ends stand for what is beyond them.
std::vector<double> mean_within(std::span<const double> values, int reach);

// The median, of an even number of values the mean of the two in the middle, or the upper of the
// two. `values` must not be empty.
double median(std::vector<double> values);
double upper_median(std::vector<double> values);

// Medians of points that do not depend on the directions of the axes, as those of single
// coordinates do.

// The geometric median: the point with the least sum of distances to `points`; outliers move it no
// more than they move a median. Zero without points. By the iteration of Weiszfeld ("Sur le point
// pour lequel la somme des distances de n points donnés est minimum", Tohoku Math. J. 43, 1937)
// from the mean and near its end that of Newton, to a nanometre or 100 rounds: points within a
// micrometre count as one.
Vec3 median_point(std::span<const Vec3> points);

// The geometric median of the points' projections on the ground, at the median of their heights
// (the mean of the two middle ones if their number is even). For places where a foot stands.
Vec3 median_place(std::span<const Vec3> points);

}  // namespace krok
