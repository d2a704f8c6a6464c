#include "draw/plot_panel_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "draw/plot.h"

namespace krok::draw {

double tick_step(double low, double high, int wanted) {
  const double least = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

namespace {

std::vector<double> linear_ticks(double low, double high, int wanted) {
  const double step = tick_step(low, high, wanted);
  std::vector<double> result;
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  // Multiplied, not accumulated, so that 0 is exact and ticks do not drift.
  for (double k = first; k <= last && result.size() < 1000; ++k) {
    result.push_back(k == 0 ? 0.0 : k * step);
  }
  return result;
}

std::vector<double> logarithmic_ticks(double low, double high, int wanted) {
  const double first = std::floor(std::log10(low) + 1e-9);
  const double last = std::ceil(std::log10(high) - 1e-9);
  const double decades = last - first;
  std::vector<double> result;
  const double every = std::max(1.0, std::ceil(decades / std::max(wanted, 1)));
  for (double power = first; power <= last; power += every) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1 && decades > 2) continue;
      const double value = factor * std::pow(10.0, power);
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)) result.push_back(value);
    }
  }
  return result.size() < 2 ? linear_ticks(low, high, wanted) : result;
}

}  // namespace

std::vector<double> ticks(double low, double high, int wanted, Scale scale) {
  return scale == Scale::linear ? linear_ticks(low, high, wanted)
                                : logarithmic_ticks(low, high, wanted);
}

namespace {

constexpr double kMin = 1e-250;       // smaller values count as 0 on an axis
constexpr double kSameValue = 1e-12;  // relative

// The smallest 1, 2 or 5 times a power of ten that is at least `value`; the inverses have the same
// form.
double round_up(double value) {
  return tick_step(0, value, 1);
}

}  // namespace

void Range::add(double value, Scale scale) {
  if (!can_show(value, scale)) return;
  if (scale == Scale::linear && std::abs(value) < kMin) value = 0;
  low = std::min(low, value);
  high = std::max(high, value);
}

Range Range::settled(Scale scale) const {
  if (!(low <= high)) return scale == Scale::linear ? Range{0.0, 1.0} : Range{1.0, 10.0};
  if (high - low > kSameValue * std::max(std::abs(low), std::abs(high))) return *this;
  const double around = low == 0 ? 1.0 : std::abs(low) * 0.5;
  return {low - around, high + around};
}

Status check_axis(const Axis& axis) {
  const bool bad = (axis.low && !std::isfinite(*axis.low)) ||
                   (axis.high && !std::isfinite(*axis.high)) ||
                   (axis.low && axis.high && *axis.low >= *axis.high) ||
                   (axis.scale == Scale::logarithmic &&
                    ((axis.low && *axis.low <= 0) || (axis.high && *axis.high <= 0)));
  if (!bad) return {};
  return Error("plot-axis", fmt::format("axis '{}': limits must be finite and increasing, and "
                                        "positive on a logarithmic axis",
                                        axis.label));
}

Mapping map_axis(const Axis& axis, const Range& values, int wanted) {
  Mapping mapping;
  mapping.scale = axis.scale;
  const auto [low, high] = values.settled(axis.scale);
  if (axis.scale == Scale::logarithmic) {
    mapping.low = axis.low.value_or(1 / round_up(1 / low));
    mapping.high = axis.high.value_or(round_up(high));
    if (mapping.high <= mapping.low) mapping.high = mapping.low * 10;
    return mapping;
  }
  const double step = tick_step(low, high, wanted);
  mapping.low = axis.low.value_or(std::floor(low / step + 1e-9) * step);
  mapping.high = axis.high.value_or(std::ceil(high / step - 1e-9) * step);
  if (mapping.high <= mapping.low) mapping.high = mapping.low + step;
  return mapping;
}

double step_of(const std::vector<double>& ticks) {
  double step = INFINITY;
  for (std::size_t i = 1; i < ticks.size(); ++i) step = std::min(step, ticks[i] - ticks[i - 1]);
  return std::isfinite(step) ? step : ticks.empty() ? 1.0 : std::max(std::abs(ticks[0]), 1e-9);
}

std::string tick_text(double value, double step, Scale scale) {
  if (scale == Scale::logarithmic) return fmt::format("{:.6g}", value);
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) {
    const int significant = static_cast<int>(std::ceil(std::log10(size / step) - 1e-9)) + 1;
    return fmt::format("{:.{}g}", value, std::clamp(significant, 3, 15));
  }
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text[0] == '-') text.replace(0, 1, "\u2212");  // a minus sign as wide as the digits
  return text;
}

std::string axis_title(const Axis& axis) {
  if (axis.label.empty() || axis.unit.empty()) return axis.label + axis.unit;
  return fmt::format("{} ({})", axis.label, axis.unit);
}

}  // namespace krok::draw
