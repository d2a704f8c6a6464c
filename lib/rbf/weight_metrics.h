#pragma once

#include "core/result.h"
#include "rbf/weight_function.h"

// How well behaved weight functions are over the range of their parameters.

namespace krok::rbf {

struct WeightMetrics {
  double least = 0, largest = 0;  // of all weights
  // The mean over the range of sum_i |H_i|^2, where H_i are the second derivatives of weight i by
  // scaled parameters (Frobenius): what a thin plate's bending energy is. They are taken from
  // slopes a fiftieth of the range apart, since the linear kernel's are not finite at its centres.
  double roughness = 0;
  double sum_error = 0;  // the largest |sum of the weights - 1|
};

// By `points` points of Sobol's sequence; the centres count for least and largest, too. Codes:
// those of WeightFunction::check().
Result<WeightMetrics> weight_metrics(const WeightFunction& function, int points = 256,
                                     const Inside& inside = {});

}  // namespace krok::rbf
