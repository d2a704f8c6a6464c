#pragma once

#include <span>

#include "math/types.h"

// A critically damped spring: the softest follower that does not swing past what it follows,
// y'' + 2 w y' + w^2 y = w^2 x with w = 2 / time.

namespace krok {

struct SpringState {
  double value = 0, velocity = 0;
};

// The state `step` seconds later, while what is followed goes evenly from `from` to `to`. Exact,
// whatever the step, so that it does not depend on the frame rate. `time` (seconds) is how far a
// spring trails behind even motion: by time * velocity. A time of 0 or less follows at once.
SpringState follow(const SpringState& state, double from, double to, double step, double time);

// A series of values at `rate` a second, in place, smoothed by a spring that runs forward and then
// back, which trails nowhere: a mean of what is before and after with the weights
// (w / 4) (1 + w |t|) exp(-w |t|), whose standard deviation is `time`. The result has no value
// beyond those of the series but near its ends, where the series goes on reflected through its end
// values. Nothing changes for a time of 0 or less.
void smooth_both_ways(std::span<double> series, double rate, double time);

// The same of each coordinate, the straight line from the first to the last taken out before and
// put back after, so that even motion is kept from end to end.
void smooth_both_ways(std::span<Vec3> series, double rate, double time);

}  // namespace krok
