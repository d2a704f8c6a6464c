#include "fit/new_rows_internal.h"

#include <algorithm>

#include "fit/blend_weights_internal.h"
#include "fit/worst_points_internal.h"

namespace krok::fit::detail {

namespace {

using rbf::InverseSearch;

constexpr int kSearchSteps = 30;        // for p'
constexpr double kFound = 1e-9;         // scaled error at which the search for p' stops
constexpr double kFoundWell = 1e-6;     // scaled error at which p' is accepted
constexpr double kLargeResidual = 0.1;  // relative to the error to be removed
constexpr double kLowMargin = 0.005;    // added to `lowest` as a safety margin
constexpr double kLowRow = 0.8;         // of `lowest`: new rows are penalised for weights below it
constexpr int kRowSteps = 10;           // of the correction that follows the solver

// The row nearest to the weights at the point that has the right parameters and no weight too low.
void find_low_row(const rbf::WeightEvaluator& evaluator, const rbf::Measure& measure,
                  const RefineOptions& options, Found& found) {
  RefineOptions gently = options;
  gently.slack = -kLowRow * options.lowest;
  found.row.resize(static_cast<std::size_t>(evaluator.examples()));
  evaluator.weights(found.point, found.row);
  found.row =
      solve_weights(measure, evaluator.inverse_ranges(), found.point, found.row, gently).weights;
  const double error =
      InverseSearch(evaluator, measure).correct(found.point, kRowSteps, kFound, found.row).after;
  const auto [least, largest] = std::ranges::minmax(found.row);
  if (!(error <= std::max(kFoundWell, kLargeResidual * found.sought))) {
    found.refusal = Refusal::residual;
    found.value = error;
  } else if (!(least >= low_limit(options) && largest <= options.largest)) {
    found.refusal = Refusal::weights;
    found.value = least >= low_limit(options) ? largest : least;
  }
}

}  // namespace

double low_limit(const RefineOptions& options) {
  return options.lowest + kLowMargin;
}

void find_row(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
              const rbf::Measure& measure, const RefineOptions& options, double usual,
              Found& found) {
  const double near = solver.distance_to_centres(found.point);
  if (near < kNear * usual) {
    found.refusal = Refusal::near;
    found.value = near;
    return;
  }
  if (found.low) {
    find_low_row(evaluator, measure, options, found);
    return;
  }
  InverseSearch search(evaluator, measure);
  std::vector<double> point = found.point;
  found.row.resize(static_cast<std::size_t>(evaluator.examples()));
  double error = search.find_point(found.point, kSearchSteps, kFound, point).after;
  evaluator.weights(point, found.row);
  if (std::ranges::min(found.row) < low_limit(options)) {
    find_low_row(evaluator, measure, options, found);
    return;
  }
  const auto off = [&] {
    const auto [least, largest] = std::ranges::minmax(found.row);
    return std::max(options.least - least, largest - options.largest);
  };
  found.by_point = error <= kFoundWell && off() <= 0;
  if (!found.by_point) {
    evaluator.weights(found.point, found.row);
    BlendWeights solved =
        solve_weights(measure, evaluator.inverse_ranges(), found.point, found.row, options);
    found.row = std::move(solved.weights);
    error = solved.error;
  }
  if (!(error <= kLargeResidual * found.sought)) {
    found.refusal = Refusal::residual;
    found.value = error;
  } else if (!(off() <= 0)) {
    found.refusal = Refusal::weights;
    const auto [least, largest] = std::ranges::minmax(found.row);
    found.value = options.least - least > largest - options.largest ? least : largest;
  }
}

}  // namespace krok::fit::detail
