#pragma once

#include <span>
#include <vector>

#include "fit/error_field_internal.h"
#include "rbf/weight_evaluator.h"

namespace krok::fit::detail {

// Fractions of the usual distance: min distance of a new point to a centre, and between points of a
// round.
inline constexpr double kNear = 0.25;
inline constexpr double kApart = 0.5;
inline constexpr double kNegligible = 1e-9;  // scaled errors below it are ignored

// Median distance from each centre to the nearest other one, in scaled parameters.
double usual_distance(const rbf::WeightFunction& function);

struct ErrorPoint {
  std::vector<double> place;  // scaled
  double error = 0;           // scaled
};

// Whether none of the others is closer than `least`.
bool is_apart(std::span<const double> place, std::span<const ErrorPoint> others, double least);

// Climbs from the worst places of a sweep, [places x d], that are spaced apart; returns the worst
// few, at most `wanted`, worst first, none closer than `avoid` to those avoided. `usual`: usual
// distance; `worst`: receives the largest error of the sweep.
std::vector<ErrorPoint> worst_points(const ErrorField& field, std::span<const double> sweep,
                                     const std::vector<ErrorPoint>& avoided, std::size_t wanted,
                                     double usual, double avoid, double& worst);

// The lowest weight at scaled places, [places x d].
double lowest_weight(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                     std::span<const double> places);

// At most `wanted` places with a weight below `limit`, lowest first, spaced from each other and
// from those avoided. `usual`: usual distance.
std::vector<std::vector<double>> low_places(const rbf::WeightFunction& function,
                                            const rbf::WeightEvaluator& evaluator,
                                            std::span<const double> places,
                                            const std::vector<ErrorPoint>& avoided,
                                            std::size_t wanted, double limit, double usual);

}  // namespace krok::fit::detail
