#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/transform.h"

// Curves of least curvature through known values. Used by plant_feet().

namespace krok::plant {

enum class Known : std::uint8_t {
  no,
  roughly,  // to be followed
  exactly
};

// A curve over the frames with known values in some of them.
struct KnownCurve {
  std::vector<Vec3> values;  // [frames]
  std::vector<Known> known;  // [frames]

  explicit KnownCurve(std::size_t frames)
      : values(frames, Vec3::Zero()), known(frames, Known::no) {}
  void set(std::size_t frame, const Vec3& value, Known how = Known::exactly) {
    values[frame] = value;
    known[frame] = how;
  }
  bool is_exact(std::size_t frame) const { return known[frame] == Known::exactly; }
};

// Standard deviation of the jitter of exactly known values from frame to frame, taken for white
// noise: the root mean square over the axes.
double jitter_of(const KnownCurve& curve);
double height_jitter_of(const KnownCurve& curve);  // of y alone

// The cutoff, 4 to 20 Hz, that leaves jitter of this standard deviation a speed of `speed` at most.
double cutoff_against(double deviation, double speed, double rate);

struct CurveOptions {
  double rate = 30;
  double cutoff = 20;    // Hz, where the response to known values falls to one half
  double fade = 0.5;     // seconds within which the curve falls to zero away from known values
  double tension = 0.1;  // seconds within which it stops following their slope
  double join = 0.05;    // seconds, see curve_through()
};

// The curve that is near the known values and bends least: the minimum of the squared second
// differences and of squared distances from known values; elsewhere of squared first differences
// and of squared distances from zero, too. One banded system (a discrete smoothing spline;
// Whittaker 1923, Eilers 2003; with tension, Schweikert 1966).
std::vector<Vec3> smooth_curve(const KnownCurve& curve, const CurveOptions& options);

// The values that are known exactly; elsewhere the smooth curve, plus the difference of such values
// next to it, faded out within `join` seconds.
std::vector<Vec3> curve_through(const KnownCurve& curve, const CurveOptions& options);

// A curve at or above `needs` (>= 0) in each frame, two derivatives continuous: their maximum
// within `reach` frames on either side, averaged over as many.
std::vector<double> smooth_above(std::span<const double> needs, int reach);

}  // namespace krok::plant
