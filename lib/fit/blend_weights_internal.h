#pragma once

#include <span>
#include <vector>

#include "fit/refine.h"

namespace krok::fit::detail {

struct BlendWeights {
  std::vector<double> weights;
  double error = 0;  // |f(w) - wanted|, scaled; infinite if there are no such weights
};

// Weights near `start`, which sum to 1, whose blend has the parameters `wanted`: the least of what
// refine.h says, by Ceres on this thread. `inverse_ranges`: [d].
BlendWeights solve_weights(const rbf::Measure& measure, std::span<const double> inverse_ranges,
                           std::span<const double> wanted, std::span<const double> start,
                           const RefineOptions& options);

}  // namespace krok::fit::detail
