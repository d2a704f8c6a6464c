#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "math/transform.h"

// Cubic Hermite curves through keys at any times, with continuous velocity (C1). A curve is stored
// as times, values and velocities, spans of equal length; times are seconds (or any unit) and
// strictly increasing. The functions that compute velocities differ in how they use the neighbours
// of a key.

namespace krok {

// The cubic from p0 (t = 0) to p1 (t = 1) with velocities v0 and v1 at its ends; `span` is its
// duration, `t` in [0, 1] the normalised time. For a span of 1:
// p(t) = (2t^3 - 3t^2 + 1) p0 + (t^3 - 2t^2 + t) v0 + (3t^2 - 2t^3) p1 + (t^3 - t^2) v1.
double hermite(double p0, double v0, double p1, double v1, double span, double t);
Vec3 hermite(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span, double t);

// Its velocity, in the time unit of `span`.
double hermite_velocity(double p0, double v0, double p1, double v1, double span, double t);
Vec3 hermite_velocity(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span,
                      double t);

// Whether a curve is open or a loop: the last key repeats the first, one cycle later, and the
// velocity is continuous through it.
enum class Ends : unsigned char { open, closed };

// Velocities for a tension a: v_i = (1 - a) (p_{i+1} - p_{i-1}) / (t_{i+1} - t_{i-1}). For evenly
// spaced keys, h apart, this is the tangent m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} - p_i))
// divided by h; for uneven ones the adjustment of Kochanek and Bartels (Interpolating splines with
// local tension, continuity, and bias control, SIGGRAPH 1984, section 4). a = 0 is the Catmull-Rom
// spline, a = 1 stops at each key. At an open end the one-sided difference is used. A single key
// has velocity 0. Closed ends need not have exactly the same value.
void tension_velocities(std::span<const double> times, std::span<const double> values,
                        double tension, Ends ends, std::span<double> velocities);
void tension_velocities(std::span<const double> times, std::span<const Vec3> values, double tension,
                        Ends ends, std::span<Vec3> velocities);

// PCHIP velocities: the curve rises where the keys rise, falls where they fall, and has its
// extremes at keys. Harmonic means of Fritsch and Butland (A method for constructing local monotone
// piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5, 1984), with three-point ends within
// the bounds of Fritsch and Carlson (Monotone piecewise cubic interpolation, SIAM J. Numer. Anal.
// 17, 1980). Vectors are computed per coordinate.
void monotone_velocities(std::span<const double> times, std::span<const double> values, Ends ends,
                         std::span<double> velocities);
void monotone_velocities(std::span<const double> times, std::span<const Vec3> values, Ends ends,
                         std::span<Vec3> velocities);

// The value of a curve at `time`, clamped to the first and the last key. Exact at key times. Needs
// at least one key. A NaN time gives the first key.
double sample_curve(std::span<const double> times, std::span<const double> values,
                    std::span<const double> velocities, double time);
Vec3 sample_curve(std::span<const double> times, std::span<const Vec3> values,
                  std::span<const Vec3> velocities, double time);

// The index of the last key at or before `time`, 0 if there is none; `times` is increasing and not
// empty. The search starts at `guess` (any number), so that slowly increasing times are found at
// once.
std::size_t key_before(std::span<const double> times, double time, std::size_t guess = 0);

// From 0 at s = 0 to 1 at s = 1 with two derivatives zero at both ends, clamped beyond: the quintic
// along which people reach (Flash and Hogan, "The coordination of arm movements", 1985).
inline double smoother_step(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

}  // namespace krok
