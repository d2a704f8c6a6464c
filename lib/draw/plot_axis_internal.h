#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "draw/plot.h"

// Private to this folder: from values to places on an axis, and the texts beside it.

namespace krok::draw {

// Whether a value has a place on such an axis. Those near the end of what doubles hold have none,
// for the length of an axis must be a number too.
inline bool can_show(double value, Scale scale) {
  constexpr double kMax = 1e250;
  return std::abs(value) <= kMax && (scale == Scale::linear || value >= 1 / kMax);
}

// Where on an axis a value lies, from 0 to 1.
struct Mapping {
  double low = 0.0, high = 1.0;
  Scale scale = Scale::linear;

  double place(double value) const {
    if (scale == Scale::linear) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
  }
  bool shows(double value) const { return can_show(value, scale); }
};

// The least and the greatest of values that an axis can show; low > high where there are none.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double value, Scale scale);
  // What an axis can cover: a stretch around one value or values that doubles hardly tell apart,
  // any where there are none.
  Range settled(Scale scale) const;
};

// plot-axis where an axis' limits are not finite, not rising, or not positive on a logarithmic one.
Status check_axis(const Axis& axis);

// The limits given, or those of the values, rounded outwards to ticks of which `wanted` are asked
// for.
Mapping map_axis(const Axis& axis, const Range& values, int wanted);

// The smallest 1, 2 or 5 times a power of ten of which no more than `wanted` fit between low and
// high; low < high.
double tick_step(double low, double high, int wanted);

// How far apart ticks are; with one or none a length for tick_text to go by.
double step_of(const std::vector<double>& ticks);

// A tick's value: as many digits as tell it from its neighbours, on a logarithmic axis its own.
std::string tick_text(double value, double step, Scale scale);

// "time (s)"; only one of both where the other is empty.
std::string axis_title(const Axis& axis);

}  // namespace krok::draw
