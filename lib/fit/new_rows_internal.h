#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

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

// Restores the rows as they were found. Affine part and coefficients are still those of the
// polished rows; a solver recomputes them.
Refined without_polish(Refined refined);

// A point to insert.
struct Found {
  std::vector<double> place, point;  // scaled; in parameter units
  double sought = 0;                 // the error there
  bool low = false;                  // a weight is too low there
  std::vector<double> row;
  bool by_point = false;
  std::optional<Refusal> refusal;
  double value = 0;  // of the refusal
};

// Weights below this are too low: slightly above RefineOptions::lowest.
double low_limit(const RefineOptions& options);

// Finds the row of a point as described in refine.h, or the reason for refusal. `usual`: usual
// distance.
void find_row(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
              const rbf::Measure& measure, const RefineOptions& options, double usual,
              Found& found);

}  // namespace krok::fit::detail
