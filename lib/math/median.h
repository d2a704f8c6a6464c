#pragma once

#include <span>

#include "math/types.h"

// Medians that do not depend on the directions of the axes, as those of single coordinates do.

namespace krok {

// The geometric median: the point with the least sum of distances to `points`; outliers move it no
// more than they move a median. Zero without points. By the iteration of Weiszfeld ("Sur le point
// pour lequel la somme des distances de n points donnés est minimum", Tohoku Math. J. 43, 1937)
// from the mean, to a nanometre or 100 rounds: points within a micrometre count as one.
Vec3 median_point(std::span<const Vec3> points);

// The geometric median of the points' projections on the ground, at the median of their heights
// (the mean of the two middle ones if their number is even). For places where a foot stands.
Vec3 median_place(std::span<const Vec3> points);

}  // namespace krok
