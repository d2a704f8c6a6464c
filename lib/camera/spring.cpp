#include "camera/spring.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "filter/rotation_series.h"

namespace krok {

namespace {

// After kMemory * time, less than a thousandth of the initial state remains.
constexpr double kMemory = 5;

void run(std::span<double> series, double step, double time) {
  SpringState state{series.front(), 0};
  double from = series.front();
  for (double& value : series) {
    const double to = value;
    state = follow(state, from, to, step, time);
    from = to;
    value = state.value;
  }
}

}  // namespace

SpringState follow(const SpringState& state, double from, double to, double step, double time) {
  if (!(step > 0)) return state;
  const double slope = (to - from) / step;
  if (!(time > 0)) return {to, slope};
  const double w = 2 / time;
  // For constant velocity the steady state is from + slope (t - time); the deviation from it decays
  // as (a + b t) exp(-w t).
  const double a = state.value - from + slope * time;
  const double b = state.velocity - slope + w * a;
  const double left = std::exp(-w * step);
  return {to - slope * time + (a + b * step) * left, slope + (b - w * (a + b * step)) * left};
}

void smooth_both_ways(std::span<double> series, double rate, double time) {
  if (series.size() < 2 || !(time > 0) || !(rate > 0)) return;
  const std::size_t size = series.size();
  const auto padding = static_cast<std::size_t>(
      std::min(std::ceil(kMemory * time * rate), static_cast<double>(size - 1)));
  std::vector<double> longer;
  longer.reserve(size + 2 * padding);
  for (std::size_t i = padding; i > 0; --i) longer.push_back(2 * series.front() - series[i]);
  longer.insert(longer.end(), series.begin(), series.end());
  for (std::size_t i = 1; i <= padding; ++i) {
    longer.push_back(2 * series.back() - series[size - 1 - i]);
  }
  for (int way = 0; way < 2; ++way) {
    run(longer, 1 / rate, time);
    std::ranges::reverse(longer);
  }
  std::copy_n(longer.begin() + static_cast<std::ptrdiff_t>(padding), size, series.begin());
}

void smooth_both_ways(std::span<Vec3> series, double rate, double time) {
  filter::smooth_positions(
      [rate, time](std::span<double> values) { smooth_both_ways(values, rate, time); }, series);
}

}  // namespace krok
