#include <algorithm>
#include <cmath>

#include "fit/error_field_internal.h"
#include "fit/held_out_internal.h"
#include "fit/low_weights_internal.h"
#include "rbf/weight_figures.h"

namespace krok::fit::detail {

namespace {

constexpr int kHeldOutPerParameter = 256;  // for each parameter
constexpr int kMostPoints = 1024;
constexpr int kOutsidePoints = 256;
constexpr int kFigurePoints = 128;  // for the range and roughness of weights

}  // namespace

std::uint64_t seed_for(std::uint64_t seed, Use use, std::size_t round) {
  return (seed * 1000003 + round) * 3 + static_cast<std::uint64_t>(use) + 1;
}

HeldOut::HeldOut(const rbf::WeightFunction& function, const rbf::Measure& measure,
                 const RefineOptions& options)
    : measure_(measure),
      options_(options),
      d_(static_cast<std::size_t>(function.dimensions)),
      within_(places_within(function,
                            options.held_out > 0
                                ? options.held_out
                                : std::min(kHeldOutPerParameter * function.dimensions, kMostPoints),
                            seed_for(options.seed, Use::held_out), options.inside)),
      outside_(places_around(function, kOutsidePoints, seed_for(options.seed, Use::outside),
                             options.inside)) {}

RefineFigures HeldOut::errors(const rbf::WeightFunction& function,
                              const rbf::WeightEvaluator& evaluator, Error* failure) const {
  RefineFigures result;
  const ErrorField field(function, evaluator, measure_, options_.inside, options_.jobs);
  const std::vector<double> within = field.at(within_, failure);
  result.within = field.by_parameter(within);
  for (std::size_t p = 0; p < count(); ++p) result.failed += std::isnan(within[p * d_]) ? 1 : 0;
  for (const double length : field.lengths(within)) {
    result.largest = std::max(result.largest, length);
    result.mean_square += length * length;
  }
  const auto measured = static_cast<int>(count()) - result.failed;
  if (measured > 0) result.mean_square /= measured;
  return result;
}

double HeldOut::lowest(const rbf::WeightFunction& function,
                       const rbf::WeightEvaluator& evaluator) const {
  return lowest_weight(function, evaluator, within_);
}

void HeldOut::add_rest(const rbf::WeightSolver& solver, const rbf::WeightEvaluator& evaluator,
                       RefineFigures& figures) const {
  const ErrorField field(solver.function(), evaluator, measure_, options_.inside, options_.jobs);
  figures.outside = field.by_parameter(field.at(outside_));
  if (const auto weights = rbf::weight_figures(solver.function(), kFigurePoints, options_.inside)) {
    figures.least_weight = weights->least;
    figures.largest_weight = weights->largest;
    figures.roughness = weights->roughness;
  }
  figures.condition = solver.condition();
}

}  // namespace krok::fit::detail
