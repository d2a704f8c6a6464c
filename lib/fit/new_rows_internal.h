#pragma once

#include <optional>
#include <vector>

#include "fit/refine.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_solver.h"

namespace krok::fit::detail {

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
