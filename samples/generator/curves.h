#pragma once

#include <span>
#include <vector>

#include "math/transform.h"

// Smooth functions of time used by the walk. All are twice continuously differentiable.

namespace krok::samples {

// 0 for x <= 0, 1 for x >= 1, with zero velocity and acceleration at both ends.
double ease(double x);

// The quintic through position, velocity and acceleration at both ends of a time interval.
template <typename T>
struct State {
  T position;
  T velocity;
  T acceleration;
};
template <typename T>
T quintic(const State<T>& from, const State<T>& to, double duration, double time) {
  const double u = time / duration;
  const double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u;
  const double half = 0.5 * duration * duration;
  return from.position * (1 - 10 * u3 + 15 * u4 - 6 * u5) +
         from.velocity * (duration * (u - 6 * u3 + 8 * u4 - 3 * u5)) +
         from.acceleration * (half * (u2 - 3 * u3 + 3 * u4 - u5)) +
         to.position * (10 * u3 - 15 * u4 + 6 * u5) +
         to.velocity * (duration * (-4 * u3 + 7 * u4 - 3 * u5)) +
         to.acceleration * (half * (u3 - 2 * u4 + u5));
}

// A curve through knots with given velocity and acceleration; constant before the first and after
// the last.
class KnotCurve {
 public:
  struct Knot {
    double time;
    double value;
    double velocity;
    double acceleration;
  };
  explicit KnotCurve(std::vector<Knot> knots) : knots_(std::move(knots)) {}
  double operator()(double time) const;

 private:
  std::vector<Knot> knots_;
};

// A curve of period 1: the Fourier series of evenly spaced samples (the first at 0), truncated
// after `harmonics`.
class PeriodicCurve {
 public:
  PeriodicCurve(std::span<const double> samples, int harmonics);
  double operator()(double phase) const;

 private:
  double mean_ = 0;
  std::vector<double> cosines_, sines_;
};

// A uniform cubic B-spline over evenly spaced keys: approximates the keys without overshoot, and
// reproduces straight lines. Constant beyond both ends.
template <typename T>
class Spline {
 public:
  Spline(std::vector<T> keys, double first_time, double spacing)
      : keys_(std::move(keys)), first_time_(first_time), spacing_(spacing) {}

  T operator()(double time) const {
    const double s = (time - first_time_) / spacing_;
    const double cell = s < -2 ? -2
                        : s > static_cast<double>(keys_.size()) + 1
                            ? static_cast<double>(keys_.size()) + 1
                            : s;
    const auto base = static_cast<long>(cell + 16) - 16;  // floor
    const double u = cell - static_cast<double>(base);
    const double v = 1 - u;
    return T(key(base - 1) * (v * v * v / 6) + key(base) * ((4 - 6 * u * u + 3 * u * u * u) / 6) +
             key(base + 1) * ((4 - 6 * v * v + 3 * v * v * v) / 6) +
             key(base + 2) * (u * u * u / 6));
  }

 private:
  const T& key(long index) const {
    const long last = static_cast<long>(keys_.size()) - 1;
    return keys_[static_cast<std::size_t>(index < 0 ? 0 : index > last ? last : index)];
  }

  std::vector<T> keys_;
  double first_time_, spacing_;
};

// Smooths samples in place with a Gaussian of `sigma` samples; the ends are extended as constants.
void smooth(std::vector<double>& samples, double sigma);

}  // namespace krok::samples
