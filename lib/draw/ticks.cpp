#include <algorithm>
#include <cmath>

#include "draw/plot.h"
#include "draw/plot_axis_internal.h"

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

}  // namespace krok::draw
