#pragma once

namespace krok::gait {

// The quintic that is 1, with slope or with acceleration 1, at s = 0, its two other derivatives
// zero, and zero with two derivatives at s = 1.
struct Fading {
  double value, slope, acceleration;
};
inline Fading fading(double s) {
  if (s >= 1) return {0, 0, 0};
  const double s2 = s * s, s3 = s2 * s;
  return {1 - s3 * (10 - s * (15 - 6 * s)), s - s3 * (6 - s * (8 - 3 * s)),
          0.5 * s2 - s3 * (1.5 - s * (1.5 - 0.5 * s))};
}

}  // namespace krok::gait
