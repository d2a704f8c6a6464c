#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"

namespace krok::rbf {

// The weights at a few points, [points x examples], of the function that WeightSolver::create()
// makes with the examples' range, equal to within the solver's residual. It needs one solution for
// each point instead of one for each example: with n examples and m points n^3 / 3 + m n^2
// operations, not 2 n^3 and more. `parameters`: [examples x d], `points`: [points x d], both in
// parameter units, finite. Codes: rbf-examples, rbf-duplicate, rbf-conditioning.
Result<std::vector<double>> point_weights(int dimensions, std::span<const double> parameters,
                                          Kernel kernel, double smoothing,
                                          std::span<const double> points);

}  // namespace krok::rbf
