#include <algorithm>
#include <cmath>

#include "fit/error_field_internal.h"
#include "fit/held_out_internal.h"
#include "fit/low_weights_internal.h"
#include "rbf/weight_metrics.h"

namespace krok::fit::detail {

namespace {

constexpr int kHeldOutPerParameter = 256;  // per parameter
constexpr int kMaxPoints = 1024;
constexpr int kOutsidePoints = 256;
constexpr int kMetricPoints = 128;  // for range and roughness of the weights

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
                                : std::min(kHeldOutPerParameter * function.dimensions, kMaxPoints),
                            seed_for(options.seed, Use::held_out), options.inside)),
      outside_(places_around(function, kOutsidePoints, seed_for(options.seed, Use::outside),
                             options.inside)) {}

RefineMetrics HeldOut::errors(const rbf::WeightFunction& function,
                              const rbf::WeightEvaluator& evaluator, Error* failure) const {
  RefineMetrics result;
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
                       RefineMetrics& metrics) const {
  const ErrorField field(solver.function(), evaluator, measure_, options_.inside, options_.jobs);
  metrics.outside = field.by_parameter(field.at(outside_));
  if (const auto weights = rbf::weight_metrics(solver.function(), kMetricPoints, options_.inside)) {
    metrics.least_weight = weights->least;
    metrics.largest_weight = weights->largest;
    metrics.roughness = weights->roughness;
  }
  metrics.condition = solver.condition();
}

}  // namespace krok::fit::detail
