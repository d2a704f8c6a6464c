#pragma once

#include <span>
#include <vector>

#include "core/result.h"

// From generic time, which counts the moments that motions have in common, to the time of each
// motion, and from the time of a blend to generic time (SOURCES: the keytimes of a blend are the
// weighted sums of its examples').

namespace krok::blend {

enum class Warp : unsigned char {
  pchip,  // a monotone cubic through the moments: speeds have no jumps
  linear  // straight between them: speeds jump at them
};

// A motion's time by generic time in [0, moments - 1], rising strictly; clamped outside.
class TimeMap {
 public:
  // `times`: of the moments, at least two, rising.
  TimeMap(std::vector<double> times, Warp warp);

  double last() const { return static_cast<double>(times_.size() - 1); }  // generic time
  double at(double generic) const;                                        // seconds
  double slope(double generic) const;  // seconds for one of generic time, >= 0
  // The same at a part in [0, 1] of an interval, whose ends belong to it.
  double slope(int interval, double part) const;

 private:
  std::vector<double> generic_, times_, slopes_;
  Warp warp_;
};

// A motion's weight by generic time: straight lines between points, the same before the first and
// after the last.
struct WeightCurve {
  std::vector<double> generic, weights;  // of the points, by rising generic time; at least one

  static WeightCurve constant(double weight) { return {{0}, {weight}}; }
  bool is_constant() const { return weights.size() == 1; }
  double at(double time) const;
};

// The time of a blend, from 0 on: a second of generic time lasts the weighted sum of what it lasts
// in the motions. With weights that do not change its moments are the weighted sums of theirs.
class BlendTime {
 public:
  // As many curves as maps, one at least; all maps have as many moments. Weights that do not sum to
  // 1 count by their shares. Codes: blend-weights where they sum to nothing (under 0.001) or are
  // no numbers; blend-interval where an interval between moments lasts less than `shortest` seconds
  // or time would run backwards.
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

  // Of the weights' shares, d seconds / d generic.
  double slope(int interval, double part) const;
  double slope(double generic) const;
  Status integrate(double shortest);

  std::vector<TimeMap> maps_;
  std::vector<WeightCurve> weights_;
  bool constant_ = true;
  std::vector<double> moments_;
  std::vector<double> table_;  // time at each part of an interval, for weights that change
};

}  // namespace krok::blend
