#include "motion/seam_curves.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

// With right(s) = v s + a s^2 / 2 after the seam and left(s) = -u s + a s^2 / 2 before it, their
// sum gives v - u and their difference v + u (the latter by least squares).
void find_rates(const std::array<Vec3, 2>& left, const std::array<Vec3, 2>& right, SeamGap& gap) {
  const Vec3 jump = 2 * (left[0] + right[0]) - 0.5 * (left[1] + right[1]);
  const Vec3 mean = ((right[0] - left[0]) + 2 * (right[1] - left[1])) / 10;
  gap.rate_before = mean - 0.5 * jump;
  gap.rate_after = mean + 0.5 * jump;
}

// The inverse right Jacobian of SO(3)'s exponential map at `v`: the derivative of v for which
// exp(v) turns at `body_rate` (Chirikjian, Stochastic Models, Information Theory, and Lie Groups,
// vol. 2, sec. 10.7).
Vec3 vector_rate(const Vec3& v, const Vec3& body_rate) {
  const double angle = v.norm();
  const double factor =
      angle < 1e-4 ? 1.0 / 12 : 1 / (angle * angle) - 0.5 / (angle * std::tan(0.5 * angle));
  return body_rate + 0.5 * v.cross(body_rate) + factor * v.cross(v.cross(body_rate));
}

}  // namespace

void SeamGap::forgive(double usual) {
  const Vec3 whole = rate_after - rate_before;
  if (jump() <= 0) return;
  const Vec3 forgiven = std::min(1.0, usual / jump()) * whole;
  rate_before += 0.5 * forgiven;
  rate_after -= 0.5 * forgiven;
}

SeamGap rotation_gap(const SeamSides& sides) {
  SeamGap gap;
  const Quat& end = sides.before[0].orientation;
  const Quat& begin = sides.after[0].orientation;
  gap.value = rotation_vector(end.conjugate() * begin);
  std::array<Vec3, 2> left, right;
  // Steps before the seam are converted to the start's frame, because the fit adds both sides.
  const Quat end_to_begin = begin.conjugate() * end;
  for (std::size_t k = 0; k < 2; ++k) {
    left[k] = end_to_begin * rotation_vector(end.conjugate() * sides.before[k + 1].orientation);
    right[k] = rotation_vector(begin.conjugate() * sides.after[k + 1].orientation);
  }
  find_rates(left, right, gap);
  gap.rate_before = end_to_begin.conjugate() * gap.rate_before;
  return gap;
}

SeamGap position_gap(const SeamSides& sides) {
  SeamGap gap;
  gap.value = sides.after[0].position - sides.before[0].position;
  std::array<Vec3, 2> left, right;
  for (std::size_t k = 0; k < 2; ++k) {
    left[k] = sides.before[k + 1].position - sides.before[0].position;
    right[k] = sides.after[k + 1].position - sides.after[0].position;
  }
  find_rates(left, right, gap);
  return gap;
}

SeamCurve::SeamCurve(const Vec3& value_before, const Vec3& slope_before, const Vec3& value_after,
                     const Vec3& slope_after, int width)
    : value_{value_after, value_before}, slope_{slope_after, slope_before}, width_(width) {}

Vec3 SeamCurve::at(bool before, int from_seam) const {
  if (from_seam >= width_) return Vec3::Zero();
  // u is 1 at the seam and 0 at the far end.
  const double u = 1 - static_cast<double>(from_seam) / width_;
  const double u3 = u * u * u;
  const double value = u3 * (10 + u * (-15 + 6 * u));
  const double slope = u3 * (-4 + u * (7 - 3 * u)) * width_;  // its derivative at u = 1 is `width_`
  const int side = before ? 1 : 0;
  return value * value_[side] + (before ? slope : -slope) * slope_[side];
}

SeamCurve position_curve(const SeamGap& gap, int width) {
  const Vec3 half = 0.5 * gap.value;
  const Vec3 slope = 0.5 * (gap.rate_after - gap.rate_before);
  return {half, slope, -half, -slope, width};
}

SeamCurve rotation_curve(const SeamGap& gap, int width) {
  // Both sides meet half-way, and so do their velocities in that frame: exp(-c) w exp(c) plus the
  // curve's rate.
  const Vec3 half = 0.5 * gap.value;
  const Vec3 before = from_rotation_vector(-half) * gap.rate_before;
  const Vec3 after = from_rotation_vector(half) * gap.rate_after;
  const Vec3 change = 0.5 * (after - before);
  return {half, vector_rate(half, change), -half, vector_rate(-half, -change), width};
}

}  // namespace krok
