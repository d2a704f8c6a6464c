#pragma once

#include <vector>

#include "core/result.h"

// Maps generic time, which numbers the moments that motions share, to the time of each motion, and
// the time of a blend to generic time (SOURCES: the keytimes of a blend are the weighted sums of
// those of its examples).

namespace krok::blend {

enum class Warp : unsigned char {
  pchip,  // monotone cubic through the moments: continuous speed
  linear  // piecewise linear: speed jumps at the moments
};

// A motion's time over generic time in [0, moments - 1], strictly increasing; clamped outside.
class TimeMap {
 public:
  // `times`: of the moments, at least two, increasing.
  TimeMap(std::vector<double> times, Warp warp);

  double last() const { return static_cast<double>(times_.size() - 1); }  // generic time
  double at(double generic) const;                                        // seconds
  double slope(double generic) const;  // seconds per unit of generic time, >= 0
  // The slope at `part` in [0, 1] of an interval; at 0 and 1 it is the one-sided slope.
  double slope(int interval, double part) const;

 private:
  std::vector<double> generic_, times_, slopes_;
  Warp warp_;
};

// A motion's weight over generic time: piecewise linear, constant before the first point and after
// the last.
struct WeightCurve {
  std::vector<double> generic, weights;  // points by increasing generic time; at least one

  static WeightCurve constant(double weight) { return {{0}, {weight}}; }
  bool is_constant() const { return weights.size() == 1; }
  double at(double time) const;
};

// The time of a blend, starting at 0: an interval of generic time lasts the weighted sum of its
// durations in the motions. With constant weights the blend's moments are the weighted sums of the
// motions' moments.
class BlendTime {
 public:
  // One curve per map, at least one map, all with the same number of moments. Weights are
  // normalised to sum to 1. Codes: blend-weights if the magnitude of their sum is below 0.001 or
  // they are not finite; blend-interval if an interval between moments is shorter than `shortest`
  // seconds or time would run backwards.
  static Result<BlendTime> create(std::vector<TimeMap> maps, std::vector<WeightCurve> weights,
                                  double shortest);

  double duration() const { return moments_.back(); }              // seconds
  const std::vector<double>& moments() const { return moments_; }  // seconds, the first is 0
  double generic_at(double time) const;
  double time_at(double generic) const;

  const std::vector<TimeMap>& maps() const { return maps_; }
  const std::vector<WeightCurve>& weights() const { return weights_; }

 private:
  BlendTime(std::vector<TimeMap> maps, std::vector<WeightCurve> weights)
      : maps_(std::move(maps)), weights_(std::move(weights)) {}

  // d seconds / d generic, with normalised weights.
  double slope(int interval, double part) const;
  double slope(double generic) const;
  Status integrate(double shortest);

  std::vector<TimeMap> maps_;
  std::vector<WeightCurve> weights_;
  bool constant_ = true;
  std::vector<double> moments_;
  std::vector<double> table_;  // time at each part of an interval, for varying weights
};

}  // namespace krok::blend
