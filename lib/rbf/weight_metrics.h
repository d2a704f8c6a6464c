#pragma once

#include "core/result.h"
#include "rbf/weight_function.h"

// Quality metrics of weight functions over the range of their parameters.

namespace krok::rbf {

struct WeightMetrics {
  double least = 0, largest = 0;  // over all weights
  // Mean over the range of sum_i |H_i|^2 (Frobenius), where H_i is the Hessian of weight i by
  // scaled parameters, as in thin-plate bending energy. From finite differences of slopes, a
  // fiftieth of the range apart, because the linear kernel has no finite Hessian at its centres.
  double roughness = 0;
  double sum_error = 0;  // max |sum of weights - 1|
};

// Sampled at `points` points of the Sobol sequence; least and largest include the centres. Codes:
// those of WeightFunction::check().
Result<WeightMetrics> weight_metrics(const WeightFunction& function, int points = 256,
                                     const Inside& inside = {});

}  // namespace krok::rbf
