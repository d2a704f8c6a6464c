#include "math/euler.h"

#include <cmath>

namespace krok {

Quat axis_rotation(Axis axis, double angle) {
  Quat q(std::cos(0.5 * angle), 0, 0, 0);
  q.coeffs()[static_cast<int>(axis)] = std::sin(0.5 * angle);
  return q;
}

Quat from_axis_rotations(std::span<const Axis> axes, std::span<const double> angles) {
  Quat q = Quat::Identity();
  for (std::size_t i = 0; i < axes.size(); ++i) q = q * axis_rotation(axes[i], angles[i]);
  return q;
}

Vec3 to_euler(const Quat& q, const EulerOrder& order, double last_at_lock) {
  const int i = static_cast<int>(order[0]);
  const int j = static_cast<int>(order[1]);
  const int k = static_cast<int>(order[2]);
  // +1 for the cyclic orders xyz, yzx, zxy, -1 for the others.
  const double parity = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;
  const Mat3 m = q.toRotationMatrix();
  // With R = Ri(a) Rj(b) Rk(c): m(i,k) = parity sin b, m(i,i) = cos b cos c,
  // m(i,j) = -parity cos b sin c, m(j,k) = -parity sin a cos b, m(k,k) = cos a cos b.
  const double sine = parity * m(i, k);
  const double cosine = std::hypot(m(i, i), m(i, j));
  const double middle = std::atan2(sine, cosine);
  if (cosine > 1e-7) {
    return {std::atan2(-parity * m(j, k), m(k, k)), middle, std::atan2(-parity * m(i, j), m(i, i))};
  }
  // Gimbal lock: remove the last rotation and read the first from the remainder.
  const Mat3 rest = (q * axis_rotation(order[2], -last_at_lock)).toRotationMatrix();
  return {std::atan2(parity * rest(k, j), rest(j, j)), middle, last_at_lock};
}

namespace {

double nearest_turn(double angle, double previous) {
  return angle + 2.0 * kPi * std::round((previous - angle) / (2.0 * kPi));
}

Vec3 nearest_turns(const Vec3& angles, const Vec3& previous) {
  return {nearest_turn(angles[0], previous[0]), nearest_turn(angles[1], previous[1]),
          nearest_turn(angles[2], previous[2])};
}

}  // namespace

Vec3 closest_euler(const Vec3& angles, const Vec3& previous) {
  const Vec3 same = nearest_turns(angles, previous);
  const Vec3 other =
      nearest_turns(Vec3(angles[0] + kPi, kPi - angles[1], angles[2] + kPi), previous);
  return (other - previous).squaredNorm() < (same - previous).squaredNorm() ? other : same;
}

}  // namespace krok
