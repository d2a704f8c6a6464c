#pragma once

#include <span>
#include <vector>

#include "fit/error_field_internal.h"

namespace krok::fit::detail {

// Parts of the usual distance between neighbours: how near to a centre no other is wanted, and how
// far the points of a round lie apart.
inline constexpr double kNear = 0.25;
inline constexpr double kApart = 0.5;
inline constexpr double kNegligible = 1e-9;  // scaled error that nobody mends

// The median of the distances from each centre to the nearest other one, in scaled parameters.
double usual_distance(const rbf::WeightFunction& function);

struct ErrorPoint {
  std::vector<double> place;  // scaled
  double error = 0;           // scaled
};

// Whether no other is nearer than that.
bool is_apart(std::span<const double> place, std::span<const ErrorPoint> others, double least);

// Climbs from the worst of the places of a sweep, [places x d], that lie apart, and gives the worst
// few, `wanted` at most, the worst first; none near those `avoided`. `usual`: the usual distance;
// `worst`: the largest error of the sweep.
std::vector<ErrorPoint> worst_points(const ErrorField& field, std::span<const double> sweep,
                                     const std::vector<ErrorPoint>& avoided, std::size_t wanted,
                                     double usual, double& worst);

}  // namespace krok::fit::detail
