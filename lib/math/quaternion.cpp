#include "math/quaternion.h"

#include <cmath>

namespace krok {

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

}  // namespace krok
