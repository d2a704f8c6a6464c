#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "camera/keyed_camera.h"
#include "math/hermite.h"

// Private to this folder: interpolation of one camera property through its keys.

namespace krok {

// Key data that does not depend on the type of the property.
struct KeyTimes {
  std::vector<double> times;     // seconds, strictly increasing
  std::vector<Between> between;  // [keys], from each to the next; the last one is unused
  std::vector<double> tensions;  // [keys]
  bool closed = false;           // all keys are smooth and the last equals the first
};

// The keys of one smooth curve: index of the first, and count.
struct SmoothRun {
  std::size_t first = 0, count = 0;
};
std::vector<SmoothRun> smooth_runs(const KeyTimes& keys);

// A time relative to the keys: the interval from `key` to the next, and the interpolation weight
// `t` after easing (0 for step and at the last key). Clamped to the keys.
struct Moment {
  std::size_t key = 0;
  double t = 0;     // in [0, 1)
  double span = 1;  // seconds from key to the next
  bool smooth = false;
};
Moment moment_at(const KeyTimes& keys, double time);

// Values with a velocity at each key for the curves that start and end there; within a run both are
// the same. `Kind` has Value, Velocity, velocities(times, values, ends, velocities), smooth(...)
// and straight(from, to, t).
template <typename Kind>
class KeyedCurve {
 public:
  using Value = typename Kind::Value;
  using Velocity = typename Kind::Velocity;

  KeyedCurve(KeyTimes keys, std::vector<Value> values)
      : keys_(std::move(keys)), values_(std::move(values)), velocities_(values_.size()) {
    for (const SmoothRun& run : smooth_runs(keys_)) {
      const auto part = [&run](auto& list) {
        return std::span(list).subspan(run.first, run.count);
      };
      std::vector<Velocity> velocities(run.count);
      Kind::velocities(std::span<const double>(part(keys_.times)),
                       std::span<const Value>(part(values_)),
                       keys_.closed ? Ends::closed : Ends::open, velocities);
      for (std::size_t i = 0; i < run.count; ++i) {
        const std::size_t key = run.first + i;
        velocities_[key] = (1 - keys_.tensions[key]) * velocities[i];
      }
    }
  }

  Value at(double time) const {
    const Moment moment = moment_at(keys_, time);
    const std::size_t k = moment.key;
    if (moment.t == 0) return values_[k];
    if (!moment.smooth) return Kind::straight(values_[k], values_[k + 1], moment.t);
    return Kind::smooth(values_[k], velocities_[k], values_[k + 1], velocities_[k + 1], moment.span,
                        moment.t);
  }

 private:
  KeyTimes keys_;
  std::vector<Value> values_;
  std::vector<Velocity> velocities_;
};

}  // namespace krok
