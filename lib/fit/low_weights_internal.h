#pragma once

#include <span>
#include <vector>

#include "fit/worst_points_internal.h"
#include "rbf/weight_evaluator.h"

namespace krok::fit::detail {

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
