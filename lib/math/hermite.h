#pragma once

#include <cstddef>
#include <span>

#include "math/types.h"

// Cubic curves through keys at times of their own, with continuous velocity (C1). A curve is held
// as times, values and velocities, spans of one length; times are seconds (or any unit) and rise
// strictly. The functions that make velocities differ in what they make of the neighbours of a key.

namespace krok {

// The cubic from p0 (t = 0) to p1 (t = 1) with the velocities v0 and v1 at its ends; `span` is the
// time from one to the other, `t` in [0, 1] the part of it that is over. For a span of 1:
// p(t) = (2t^3 - 3t^2 + 1) p0 + (t^3 - 2t^2 + t) v0 + (3t^2 - 2t^3) p1 + (t^3 - t^2) v1.
double hermite(double p0, double v0, double p1, double v1, double span, double t);
Vec3 hermite(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span, double t);

// Its velocity, by the same time as `span` is given in.
double hermite_velocity(double p0, double v0, double p1, double v1, double span, double t);
Vec3 hermite_velocity(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double span,
                      double t);

// Whether a curve begins and ends by itself or closes to a loop: the last key is the first again,
// one round later, and the velocity goes on through it.
enum class Ends : unsigned char { open, closed };

// Velocities for a tension a: v_i = (1 - a) (p_{i+1} - p_{i-1}) / (t_{i+1} - t_{i-1}). For evenly
// spaced keys, h apart, that is the tangent m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} - p_i))
// divided by h; for others what Kochanek and Bartels make of it (Interpolating splines with local
// tension, continuity, and bias control, SIGGRAPH 1984, section 4). a = 0 is the Catmull-Rom
// spline, a = 1 rests at each key. At an open end the one difference stands for both. A single key
// has velocity 0. Closed ends need not have exactly the same value.
void tension_velocities(std::span<const double> times, std::span<const double> values,
                        double tension, Ends ends, std::span<double> velocities);
void tension_velocities(std::span<const double> times, std::span<const Vec3> values, double tension,
                        Ends ends, std::span<Vec3> velocities);

// Velocities with which the curve rises where the keys rise, falls where they fall, and has its
// extremes at keys: the harmonic means of Fritsch and Butland (A method for constructing local
// monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5, 1984), with ends by three
// points within the bounds of Fritsch and Carlson (Monotone piecewise cubic interpolation, SIAM J.
// Numer. Anal. 17, 1980): what is known as PCHIP. Vectors coordinate by coordinate.
void monotone_velocities(std::span<const double> times, std::span<const double> values, Ends ends,
                         std::span<double> velocities);
void monotone_velocities(std::span<const double> times, std::span<const Vec3> values, Ends ends,
                         std::span<Vec3> velocities);

// The value of a curve at `time`: the first key's before it, the last key's after it. At a key's
// own time exactly the key. Needs one key or more. A time that is not a number is the beginning.
double sample_curve(std::span<const double> times, std::span<const double> values,
                    std::span<const double> velocities, double time);
Vec3 sample_curve(std::span<const double> times, std::span<const Vec3> values,
                  std::span<const Vec3> velocities, double time);

// The last key at or before `time`, 0 where there is none; `times` rises and is not empty. Begins
// to look at `guess` (any number), so that times that rise bit by bit are found at once.
std::size_t key_before(std::span<const double> times, double time, std::size_t guess = 0);

}  // namespace krok
