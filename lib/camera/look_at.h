#pragma once

#include <span>
#include <vector>

#include "math/transform.h"

// Camera orientations (camera_to_world): a camera looks along its own -Z with +Y up. World up is
// +Y.

namespace krok {

// The orientation of a camera at `eye` that looks at `target`, with image up as close to world up
// as possible. Looking straight up or down (within 0.1 degrees), where world up is undefined, it is
// `before`, the previous orientation, rotated along the shortest arc to look at the target. If
// target and eye coincide or are not finite, it is `before`.
Quat look_at(const Vec3& eye, const Vec3& target, const Quat& before);

// The same for a series of times, each with its predecessor as `before`. If the camera looks
// straight up or down from the start, it takes the up of the first time that has one; if none has,
// image up is -Z looking down and +Z looking up.
std::vector<Quat> look_at(std::span<const Vec3> eyes, std::span<const Vec3> targets);

// The orientation of a camera that looks at something from the direction given by `azimuth` about
// +Y (0 is +Z, a quarter turn is +X) and `elevation` (-pi/2 .. pi/2). Defined for looking straight
// up and down too. The camera's position is the target plus the distance times the orientation's
// +Z.
Quat looking_from(double azimuth, double elevation);

// Rolls the camera to its right by `angle` radians about its view direction: the horizon tilts to
// the left in the image.
Quat rolled(const Quat& orientation, double angle);

// A critically damped spring, which follows without overshoot: y'' + 2 w y' + w^2 y = w^2 x with w
// = 2 / time.

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
