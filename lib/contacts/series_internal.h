#pragma once

#include <vector>

#include "math/transform.h"

// Point tracks over frames: filtering, velocities, breaks, jitter.

namespace krok::contacts {

// The track low-pass filtered forwards and backwards at `cutoff` Hz; unchanged if the rate is under
// 2.5 times that or the cutoff is 0.
std::vector<Vec3> smoothed(const std::vector<Vec3>& track, double rate, double cutoff);

// Metres per second, by central differences; at the ends the slope of the parabola through three
// frames.
std::vector<Vec3> velocities(const std::vector<Vec3>& track, double rate);
std::vector<double> norms(const std::vector<Vec3>& vectors);

// The time near `guess` (fractional frames) at which a moving point comes to rest (`arrives`) or a
// resting one starts to move. Two pieces that meet at that time are fitted by least squares to the
// positions within `window` frames: on the moving side a cubic that starts without velocity (or a
// parabola with velocity if that fits far better), on the resting side a line of slow drift; the
// best fit wins. `guess` if there are fewer than seven frames. `stiffness` penalises the drift.
double break_near(const std::vector<Vec3>& track, double guess, double window, bool arrives,
                  double stiffness = 0.3);

// Standard deviation of a track's frame-to-frame jitter (metres, the worse of height and
// the ground's directions), assumed to be white noise, from the lower quartile of its third
// differences.
double jitter_of(const std::vector<Vec3>& track);

// The cutoff (Hz) at which jitter of that deviation adds no more speed than `speed` (metres per
// second, root mean square over three axes); `rate` if there is no jitter.
double cutoff_for(double jitter, double speed, double rate);
// The inverse: the speed that remains.
double speed_jitter(double jitter, double cutoff, double rate);

}  // namespace krok::contacts
