#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

// Curves of least curvature through what is known of them. Used by plant_feet().

namespace krok::plant {

// A curve over the frames that is known in some.
struct KnownCurve {
  std::vector<Vec3> values;         // [frames]
  std::vector<std::uint8_t> known;  // [frames]

  explicit KnownCurve(std::size_t frames) : values(frames, Vec3::Zero()), known(frames, 0) {}
  void set(std::size_t frame, const Vec3& value) {
    values[frame] = value;
    known[frame] = 1;
  }
};

// The deviation of the known values' jitter from frame to frame, taken for white noise, over all
// axes: the root mean square of one axis.
double jitter_of(const KnownCurve& curve);

// Hertz: the cutoff at which jitter of `deviation` is left with a speed of `speed` at most, within
// 4 and 20 Hz.
double cutoff_against(double deviation, double speed, double rate);

// The curve that is near the known values and bends least: the minimum of the squared second
// differences, of squared distances from known values, and of squared distances from zero
// elsewhere. Its response to known values falls to one half at `cutoff` Hz; away from them it falls
// to zero within about `fade` seconds. One banded system (a discrete smoothing spline; Whittaker
// 1923, Eilers 2003).
std::vector<Vec3> smooth_curve(const KnownCurve& curve, double rate, double cutoff, double fade);

// The same where values are known, exactly; elsewhere the smooth curve, and next to known frames
// what these differ from it by, faded out within `join` seconds.
std::vector<Vec3> curve_through(const KnownCurve& curve, double rate, double cutoff, double fade,
                                double join);

// A curve below or at `bounds` (<= 0) in each frame, two derivatives continuous: their minimum
// within `reach` frames on either side, averaged over as many.
std::vector<double> smooth_below(std::span<const double> bounds, int reach);

}  // namespace krok::plant
