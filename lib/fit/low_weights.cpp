#include "fit/low_weights_internal.h"

#include <algorithm>
#include <numeric>

#include "fit/error_field_internal.h"

namespace krok::fit::detail {

namespace {

// The lowest weight at each place.
std::vector<double> lowest_at(const rbf::WeightFunction& function,
                              const rbf::WeightEvaluator& evaluator,
                              std::span<const double> places) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  std::vector<double> point(d), weights(static_cast<std::size_t>(function.examples)), lowest;
  for (std::size_t p = 0; p < places.size(); p += d) {
    unscale(function, places.subspan(p, d), point);
    evaluator.weights(point, weights);
    lowest.push_back(std::ranges::min(weights));
  }
  return lowest;
}

}  // namespace

double lowest_weight(const rbf::WeightFunction& function, const rbf::WeightEvaluator& evaluator,
                     std::span<const double> places) {
  const std::vector<double> lowest = lowest_at(function, evaluator, places);
  return lowest.empty() ? 0 : std::ranges::min(lowest);
}

std::vector<std::vector<double>> low_places(const rbf::WeightFunction& function,
                                            const rbf::WeightEvaluator& evaluator,
                                            std::span<const double> places,
                                            const std::vector<ErrorPoint>& avoided,
                                            std::size_t wanted, double limit, double usual) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const std::vector<double> lowest = lowest_at(function, evaluator, places);
  std::vector<std::size_t> order(lowest.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t p) { return lowest[p]; });
  std::vector<std::vector<double>> found;
  std::vector<ErrorPoint> taken;
  for (const std::size_t p : order) {
    if (found.size() == wanted || !(lowest[p] < limit)) break;
    const auto place = places.subspan(p * d, d);
    if (!is_apart(place, taken, kApart * usual) || !is_apart(place, avoided, kNear * usual)) {
      continue;
    }
    found.emplace_back(place.begin(), place.end());
    taken.push_back({found.back(), 0});
  }
  return found;
}

}  // namespace krok::fit::detail
