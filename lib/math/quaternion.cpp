#include "math/quaternion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace krok {

namespace {

// The rotation vector of the shorter arc from a to b, in a's frame (and in b's, since it is the
// axis).
Vec3 arc(const Quat& a, const Quat& b) {
  return rotation_vector(a.conjugate() * b);
}

// Slerp without a sign change, so that nothing jumps where the inner curves are more than a quarter
// of the 4-D circle apart.
Quat slerp_as_signed(const Quat& a, const Quat& b, double t) {
  const double angle =
      2.0 * std::atan2((b.coeffs() - a.coeffs()).norm(), (b.coeffs() + a.coeffs()).norm());
  const double sine = std::sin(angle);
  // Too close to divide by the sine, or opposite, where all arcs are equally long: lerp.
  if (!(sine > 5e-7))
    return normalized_or_identity(Quat(Vec4(a.coeffs() * (1 - t) + b.coeffs() * t)));
  return normalized_or_identity(Quat(Vec4(a.coeffs() * (std::sin((1 - t) * angle) / sine) +
                                          b.coeffs() * (std::sin(t * angle) / sine))));
}

}  // namespace

Quat normalized_or_identity(const Quat& q) {
  const double length = q.coeffs().stableNorm();
  if (!(length > 1e-150) || !std::isfinite(length)) return Quat::Identity();
  return Quat(Vec4(q.coeffs() / length));
}

Quat in_hemisphere_of(const Quat& reference, const Quat& q) {
  return reference.dot(q) < 0 ? Quat(Vec4(-q.coeffs())) : q;
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat difference = a.conjugate() * b;
  return 2.0 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

Quat nlerp(const Quat& a, const Quat& b, double t) {
  const Quat near_b = in_hemisphere_of(a, b);
  return normalized_or_identity(Quat(Vec4(a.coeffs() * (1.0 - t) + near_b.coeffs() * t)));
}

Quat slerp(const Quat& a, const Quat& b, double t) {
  const Quat near_b = in_hemisphere_of(a, b);
  // The 4-D arc between the two, half the rotation angle.
  const double arc = 2.0 * std::atan2((near_b.coeffs() - a.coeffs()).norm(),
                                      (near_b.coeffs() + a.coeffs()).norm());
  if (arc < 5e-7) return nlerp(a, near_b, t);
  const double scale = 1.0 / std::sin(arc);
  return normalized_or_identity(Quat(Vec4(a.coeffs() * (std::sin((1.0 - t) * arc) * scale) +
                                          near_b.coeffs() * (std::sin(t * arc) * scale))));
}

Vec3 rotation_vector(const Quat& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Vec3 axis_sine = sign * q.vec();
  const double sine = axis_sine.norm();
  const double half_angle = std::atan2(sine, sign * q.w());
  // For small angles the factor tends to 2 / w.
  const double factor = sine < 1e-12 ? 2.0 : 2.0 * half_angle / sine;
  return axis_sine * factor;
}

Quat from_rotation_vector(const Vec3& v) {
  const double angle = v.norm();
  const double half = 0.5 * angle;
  // sin(half) / angle tends to 1/2 for small angles.
  const double factor = angle < 1e-12 ? 0.5 : std::sin(half) / angle;
  const Vec3 xyz = v * factor;
  return normalized_or_identity(Quat(std::cos(half), xyz.x(), xyz.y(), xyz.z()));
}

Quat shortest_arc(const Vec3& from, const Vec3& to) {
  const double from_length = from.stableNorm();
  const double to_length = to.stableNorm();
  if (!(from_length > 0) || !(to_length > 0)) return Quat::Identity();
  const Vec3 a = from / from_length;
  const Vec3 b = to / to_length;
  const Vec3 axis = a.cross(b);
  const double cosine = a.dot(b);
  if (cosine < 0 && axis.norm() < 1e-12) {
    // Opposite: 180 degrees about an axis perpendicular to a, made from the coordinate axis with
    // the smallest component of a.
    int least = 0;
    a.cwiseAbs().minCoeff(&least);
    const Vec3 perpendicular = a.cross(Vec3::Unit(least)).normalized();
    return Quat(0, perpendicular.x(), perpendicular.y(), perpendicular.z());
  }
  // The half angle's cosine or sine is half the length of the sum or difference, whichever is
  // longer, so that both are accurate at any angle.
  const double sine = axis.norm();
  if (!(sine > 0)) return Quat::Identity();
  const double longer = 0.5 * (cosine < 0 ? Vec3(a - b) : Vec3(a + b)).norm(),
               shorter = 0.5 * sine / longer;
  const Vec3 xyz = axis * ((cosine < 0 ? longer : shorter) / sine);
  return normalized_or_identity(Quat(cosine < 0 ? shorter : longer, xyz.x(), xyz.y(), xyz.z()));
}

void squad_velocities(std::span<const double> times, std::span<const Quat> rotations,
                      double tension, Ends ends, std::span<Vec3> velocities) {
  assert(times.size() == rotations.size() && times.size() == velocities.size());
  if (times.size() < 2) {
    std::ranges::fill(velocities, Vec3::Zero());
    return;
  }
  const std::size_t last = times.size() - 1;
  const double share = 1 - tension;
  // Velocity at a key between two segments.
  const auto through = [&](std::size_t from, std::size_t to) {
    const Vec3 before = arc(rotations[from], rotations[from + 1]);
    const Vec3 after = arc(rotations[to], rotations[to + 1]);
    const double spans = times[from + 1] - times[from] + times[to + 1] - times[to];
    return Vec3((share / spans) * (before + after));
  };
  const auto along = [&](std::size_t from) {
    const double span = times[from + 1] - times[from];
    return Vec3((share / span) * arc(rotations[from], rotations[from + 1]));
  };
  for (std::size_t i = 1; i < last; ++i) velocities[i] = through(i - 1, i);
  velocities[0] = ends == Ends::open ? along(0) : through(last - 1, 0);
  velocities[last] = ends == Ends::open ? along(last - 1) : velocities[0];
}

Quat squad(const Quat& q0, const Vec3& w0, const Quat& q1, const Vec3& w1, double span, double t) {
  const Quat near_q1 = in_hemisphere_of(q0, q1);
  const Vec3 way = arc(q0, near_q1);
  const Quat s0 = q0 * from_rotation_vector(0.5 * (span * w0 - way));
  const Quat s1 = near_q1 * from_rotation_vector(0.5 * (way - span * w1));
  return slerp_as_signed(slerp_as_signed(q0, near_q1, t), slerp_as_signed(s0, s1, t),
                         2 * t * (1 - t));
}

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
