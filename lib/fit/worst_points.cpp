#include "fit/worst_points_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fit/error_field_internal.h"

namespace krok::fit::detail {

namespace {

constexpr std::size_t kMinStarts = 8;  // of climbs

double distance(std::span<const double> a, std::span<const double> b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square);
}

}  // namespace

bool is_apart(std::span<const double> place, std::span<const ErrorPoint> others, double least) {
  return std::ranges::all_of(
      others, [&](const ErrorPoint& other) { return distance(place, other.place) >= least; });
}

double usual_distance(const rbf::WeightFunction& function) {
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto count = static_cast<std::size_t>(function.centre_count());
  std::vector<double> places(count * d);
  for (std::size_t k = 0; k < count; ++k) {
    function.scale(function.centre(static_cast<int>(k)), std::span(places).subspan(k * d, d));
  }
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      const double apart =
          distance(std::span(places).subspan(k * d, d), std::span(places).subspan(i * d, d));
      nearest[k] = std::min(nearest[k], apart);
      nearest[i] = std::min(nearest[i], apart);
    }
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::ranges::nth_element(nearest, middle);
  return *middle;
}

std::vector<ErrorPoint> worst_points(const ErrorField& field, std::span<const double> sweep,
                                     const std::vector<ErrorPoint>& avoided, std::size_t wanted,
                                     double usual, double avoid, double& worst) {
  const std::size_t d = field.dimensions();
  const std::vector<double> lengths = field.lengths(field.at(sweep));
  std::vector<std::size_t> order(lengths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return lengths[a] > lengths[b]; });
  worst = order.empty() ? 0 : lengths[order.front()];

  std::vector<ErrorPoint> starts;
  std::vector<double> climbing;
  for (const std::size_t p : order) {
    if (starts.size() >= std::max(2 * wanted, kMinStarts) || !(lengths[p] > kNegligible)) break;
    const auto place = sweep.subspan(p * d, d);
    if (!is_apart(place, starts, kApart * usual) || !is_apart(place, avoided, avoid)) {
      continue;
    }
    starts.push_back({{place.begin(), place.end()}, lengths[p]});
    climbing.insert(climbing.end(), place.begin(), place.end());
  }
  const std::vector<double> heights = field.climb(climbing, kApart * usual);
  // If a climb ends near an avoided point, its start may still be usable.
  for (std::size_t s = 0; s < starts.size(); ++s) {
    const auto top = std::span(climbing).subspan(s * d, d);
    if (!is_apart(top, avoided, avoid)) continue;
    starts[s] = {{top.begin(), top.end()}, heights[s]};
  }
  std::ranges::stable_sort(
      starts, [](const ErrorPoint& a, const ErrorPoint& b) { return a.error > b.error; });
  std::vector<ErrorPoint> found;
  for (ErrorPoint& start : starts) {
    if (found.size() == wanted) break;
    if (is_apart(start.place, found, kApart * usual)) found.push_back(std::move(start));
  }
  return found;
}

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
