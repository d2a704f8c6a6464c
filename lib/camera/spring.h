#pragma once

#include <span>

#include "math/types.h"

// A critically damped spring, which follows without overshoot: y'' + 2 w y' + w^2 y = w^2 x with w
// = 2 / time.

namespace krok {

struct SpringState {
  double value = 0, velocity = 0;
};

// The state `step` seconds later, while the target moves linearly from `from` to `to`. Exact for
// any step, so independent of the frame rate. `time` (seconds) sets the lag: at constant velocity
// the spring trails by time * velocity. A time of 0 or less follows without lag.
SpringState follow(const SpringState& state, double from, double to, double step, double time);

// Smooths a series at `rate` Hz in place with a spring run forward and then backward, so without
// lag: a weighted mean with weights (w / 4) (1 + w |t|) exp(-w |t|) and standard deviation `time`.
// The result stays within the range of the series except near its ends, where the series is
// reflected through its end values. A time of 0 or less changes nothing.
void smooth_both_ways(std::span<double> series, double rate, double time);

// Smooths each coordinate, after subtracting the line from the first to the last value, which is
// added back, so that motion at constant velocity is unchanged up to both ends.
void smooth_both_ways(std::span<Vec3> series, double rate, double time);

}  // namespace krok
