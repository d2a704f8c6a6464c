#pragma once

#include <span>
#include <vector>

#include "fit/refine.h"

namespace krok::fit::detail {

struct BlendWeights {
  std::vector<double> weights;
  double error = 0;  // |f(w) - wanted|, scaled; infinity if there are no such weights
};

// Finds weights near `start` (sum 1) whose blend has the parameters `wanted`: minimises the cost in
// refine.h with Ceres, on this thread. `inverse_ranges`: [d].
BlendWeights solve_weights(const rbf::Measure& measure, std::span<const double> inverse_ranges,
                           std::span<const double> wanted, std::span<const double> start,
                           const RefineOptions& options);

}  // namespace krok::fit::detail
