#include "rbf/weight_function.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rbf/sobol.h"
#include "rbf/weight_evaluator.h"

namespace krok::rbf {

namespace {

constexpr double kStep = 0.01;  // of the range, in each direction

void take(std::span<const double> weights, WeightMetrics& metrics) {
  const auto [least, largest] = std::ranges::minmax(weights);
  metrics.least = std::min(metrics.least, least);
  metrics.largest = std::max(metrics.largest, largest);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  metrics.sum_error = std::max(metrics.sum_error, std::abs(sum - 1));
}

}  // namespace

Result<WeightMetrics> weight_metrics(const WeightFunction& function, int points,
                                     const Inside& inside) {
  auto evaluator = WeightEvaluator::create(function);
  if (!evaluator) return evaluator.error();
  const auto d = static_cast<std::size_t>(function.dimensions);
  const auto n = static_cast<std::size_t>(function.examples);
  WeightMetrics metrics;
  std::vector<double> point(d), weights(n), below(d * n), above(d * n);
  for (int k = 0; k < function.centre_count(); ++k) {
    evaluator->weights(function.centre(k), weights);
    take(weights, metrics);
  }
  const std::vector<double> all = points_inside(function, points, 0, inside);
  double sum = 0;
  for (std::size_t p = 0; p * d < all.size(); ++p) {
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(p * d), d, point.begin());
    evaluator->weights(point, weights);
    take(weights, metrics);
    for (std::size_t a = 0; a < d; ++a) {
      const double middle = point[a];
      const double range_a = function.upper[a] - function.lower[a];
      point[a] = middle - kStep * range_a;
      evaluator->slopes(point, weights, below);
      point[a] = middle + kStep * range_a;
      evaluator->slopes(point, weights, above);
      point[a] = middle;
      for (std::size_t b = 0; b < d; ++b) {
        const double scale = (function.upper[b] - function.lower[b]) / (2 * kStep);
        for (std::size_t j = 0; j < n; ++j) {
          sum += std::pow((above[b * n + j] - below[b * n + j]) * scale, 2);
        }
      }
    }
  }
  if (!all.empty())
    metrics.roughness = sum * static_cast<double>(d) / static_cast<double>(all.size());
  return metrics;
}

}  // namespace krok::rbf
