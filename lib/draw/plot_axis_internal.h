#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "draw/plot.h"

// Private to this folder: mapping of values to axis positions, and tick labels.

namespace krok::draw {

// Whether a value can be drawn on such an axis. Values near the limits of double cannot, because
// the length of the axis would overflow.
inline bool can_show(double value, Scale scale) {
  constexpr double kMax = 1e250;
  return std::abs(value) <= kMax && (scale == Scale::linear || value >= 1 / kMax);
}

// Maps values to axis positions in [0, 1].
struct Mapping {
  double low = 0.0, high = 1.0;
  Scale scale = Scale::linear;

  double place(double value) const {
    if (scale == Scale::linear) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
  }
  bool shows(double value) const { return can_show(value, scale); }
};

// The min and max of the values that an axis can show; low > high if there are none.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double value, Scale scale);
  // A valid axis range: widened around a single value or values too close together for double,
  // arbitrary if there are no values.
  Range settled(Scale scale) const;
};

// plot-axis if the limits are not finite, not increasing, or not positive on a logarithmic axis.
Status check_axis(const Axis& axis);

// The given limits, or those of the values, rounded outwards to about `wanted` ticks.
Mapping map_axis(const Axis& axis, const Range& values, int wanted);

// The smallest 1, 2 or 5 times a power of ten of which at most `wanted` fit between low and high;
// low < high.
double tick_step(double low, double high, int wanted);

// The distance between ticks; with fewer than two, a length that tick_text can use.
double step_of(const std::vector<double>& ticks);

// A tick label: as many digits as distinguish it from its neighbours; on a logarithmic axis, from
// its own value.
std::string tick_text(double value, double step, Scale scale);

// "time (s)"; label or unit alone if the other is empty.
std::string axis_title(const Axis& axis);

}  // namespace krok::draw
