#pragma once

#include <vector>

#include "math/types.h"

// Movement of points over the frames.

namespace krok::contacts {

// The track low-passed both ways at `cutoff` Hz; as it is where the rate is under 2.5 times that
// or the cutoff is 0.
std::vector<Vec3> smoothed(const std::vector<Vec3>& track, double rate, double cutoff);

// Metres a second, from the neighbouring frames' difference; at the ends the slope of the parabola
// through three frames.
std::vector<Vec3> velocities(const std::vector<Vec3>& track, double rate);
std::vector<double> norms(const std::vector<Vec3>& vectors);

// The median (of an even number the upper one); `values` is not empty.
double middle(std::vector<double> values);

// The moment near `guess` (frames, with fractions) at which a point that moves comes to stay
// (`arrives`) or one that stays goes. Two pieces are fitted by least squares to the positions
// within `window` frames: a cubic for the moving side that begins without velocity of its own (a
// parabola with one where that fits far better), a line of slow drift for the staying side; they
// meet at the moment, and the one that fits best is it. `guess` where there are fewer than seven
// frames. `stiffness` holds the drift down.
double break_near(const std::vector<Vec3>& track, double guess, double window, bool arrives,
                  double stiffness = 0.3);

// The deviation of a track's jitter from frame to frame (metres, the worst axis), taken for white
// noise, from the lower quartile of its third differences.
double jitter_of(const std::vector<Vec3>& track);

// The cutoff (Hz) at which jitter of that deviation makes no more speed than `speed` (metres a
// second, root mean square over three axes); `rate` where there is none.
double cutoff_for(double jitter, double speed, double rate);
// The inverse: the speed that is left.
double speed_jitter(double jitter, double cutoff, double rate);

}  // namespace krok::contacts
