#include "ik/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok::ik {

namespace {

// A half axis of 0 still is an ellipse.
constexpr double kThinnest = 1e-9;

double wrapped_about(double angle, double middle) {
  const double turns = std::round((angle - middle) / (2 * kPi));
  return angle - turns * 2 * kPi;
}

// Twist angle of d about a unit axis; 0 where the swing is half a turn and the twist is undefined.
double twist_of(const Quat& d, const Vec3& axis) {
  const double along = d.vec().dot(axis);
  if (along * along + d.w() * d.w() < 1e-24) return 0;
  return wrapped_about(2 * std::atan2(along, d.w()), 0);
}

// The swing's rotation vector, perpendicular to the axis, from the direction that the axis takes.
std::array<double, 2> swing_of(const JointLimit& limit, const Quat& d) {
  const Vec3 y = d * limit.axis;
  const Vec3 second = limit.axis.cross(limit.swing_axis);
  const double a = -y.dot(second), b = y.dot(limit.swing_axis);
  const double sine = std::sqrt(a * a + b * b), cosine = y.dot(limit.axis);
  if (sine < 1e-12) return {cosine > 0 ? a : kPi, cosine > 0 ? b : 0.0};
  const double scale = std::atan2(sine, cosine) / sine;
  return {scale * a, scale * b};
}

double half_axis(const JointLimit& limit, std::size_t i, double value) {
  return std::max(kThinnest, value < 0 ? -limit.min_swing[i] : limit.max_swing[i]);
}

// The point of the ellipse with half axes e next to (x, y), both in the first quadrant and outside:
// the root t of (e0 x / (t + e0^2))^2 + (e1 y / (t + e1^2))^2 = 1, which is convex and falling, so
// that Newton's method from the left is safe (Eberly, "Distance from a point to an ellipse").
std::array<double, 2> nearest_on_ellipse(double e0, double e1, double x, double y) {
  double t = std::max(e0 * x - e0 * e0, e1 * y - e1 * e1);
  for (int i = 0; i < 60; ++i) {
    const double u = e0 * x / (t + e0 * e0), v = e1 * y / (t + e1 * e1);
    const double f = u * u + v * v - 1;
    if (!(f > 1e-15)) break;
    t += f / (2 * (u * u / (t + e0 * e0) + v * v / (t + e1 * e1)));
  }
  const double u = e0 * x / (t + e0 * e0), v = e1 * y / (t + e1 * e1);
  // What rounding leaves outside is put on the ellipse.
  const double length = std::max(1.0, std::hypot(u, v));
  return {e0 * u / length, e1 * v / length};
}

bool full_turn(const JointLimit& limit) {
  return limit.max_twist - limit.min_twist >= 2 * kPi - 1e-12;
}

}  // namespace

bool JointLimit::operator==(const JointLimit& other) const {
  return kind == other.kind && zero.coeffs() == other.zero.coeffs() && axis == other.axis &&
         swing_axis == other.swing_axis && min_twist == other.min_twist &&
         max_twist == other.max_twist && min_swing == other.min_swing &&
         max_swing == other.max_swing;
}

LimitAngles measure(const JointLimit& limit, const Quat& joint_to_parent) {
  const Quat d = limit.zero.conjugate() * joint_to_parent;
  LimitAngles angles;
  angles.twist = twist_of(d, limit.axis);
  if (limit.kind == JointLimit::Kind::hinge) {
    angles.twist = wrapped_about(angles.twist, 0.5 * (limit.min_twist + limit.max_twist));
    const double along = d.vec().dot(limit.axis);
    angles.off_axis =
        2 * std::atan2(d.vec().cross(limit.axis).norm(), std::sqrt(d.w() * d.w() + along * along));
  } else {
    angles.swing = swing_of(limit, d);
  }
  return angles;
}

Quat compose(const JointLimit& limit, double twist, const std::array<double, 2>& swing) {
  const Vec3 second = limit.axis.cross(limit.swing_axis);
  const Quat turn(Eigen::AngleAxisd(twist, limit.axis));
  if (swing[0] == 0 && swing[1] == 0) return limit.zero * turn;
  return limit.zero * from_rotation_vector(swing[0] * limit.swing_axis + swing[1] * second) * turn;
}

std::array<double, 2> nearest_swing(const JointLimit& limit, const std::array<double, 2>& swing) {
  const double e0 = half_axis(limit, 0, swing[0]), e1 = half_axis(limit, 1, swing[1]);
  const double x = std::abs(swing[0]), y = std::abs(swing[1]);
  const double u = x / e0, v = y / e1;
  if (u * u + v * v <= 1 + 1e-12) return swing;
  const auto nearest = nearest_on_ellipse(e0, e1, x, y);
  return {std::copysign(nearest[0], swing[0]), std::copysign(nearest[1], swing[1])};
}

Quat clamped(const JointLimit& limit, const Quat& joint_to_parent) {
  if (limit.kind == JointLimit::Kind::free || limit.kind == JointLimit::Kind::locked) {
    return joint_to_parent;
  }
  const LimitAngles angles = measure(limit, joint_to_parent);
  double twist = angles.twist;
  if (!full_turn(limit)) twist = std::clamp(twist, limit.min_twist, limit.max_twist);
  // Rounding may leave a rotation a little off, which must not start it drifting.
  const bool twist_inside = std::abs(twist - angles.twist) < 1e-12;
  if (limit.kind == JointLimit::Kind::hinge) {
    if (twist_inside && angles.off_axis < 1e-12) return joint_to_parent;
    return compose(limit, twist, {0, 0});
  }
  const auto swing = nearest_swing(limit, angles.swing);
  if (twist_inside && swing == angles.swing) return joint_to_parent;
  return compose(limit, twist, swing);
}

double excess(const JointLimit& limit, const Quat& joint_to_parent) {
  return angle_between(joint_to_parent, clamped(limit, joint_to_parent));
}

LimitGradients gradients(const JointLimit& limit, const Quat& joint_to_parent) {
  LimitGradients result;
  const Quat d = limit.zero.conjugate() * joint_to_parent;
  // d exp(r): dw = -v.r / 2, dv = (w r + v x r) / 2; the twist is 2 atan2(v.axis, w).
  const Vec3 v = d.vec();
  const double along = v.dot(limit.axis);
  const double square = along * along + d.w() * d.w();
  if (square > 1e-12) {
    result.twist = (d.w() * (d.w() * limit.axis + limit.axis.cross(v)) + along * v) / square;
  }
  // The swing follows from y = d axis alone, dy = d (r x axis).
  const Vec3 second = limit.axis.cross(limit.swing_axis);
  const Vec3 y = d * limit.axis;
  const double yu = y.dot(limit.swing_axis), yv = y.dot(second), yz = y.dot(limit.axis);
  const double sine = std::hypot(yu, yv);
  if (sine < 1e-9) return result;
  const double angle = std::atan2(sine, yz), scale = angle / sine;
  const double a = -scale * yv, b = scale * yu;
  const double e0 = half_axis(limit, 0, a), e1 = half_axis(limit, 1, b);
  for (int i = 0; i < 3; ++i) {
    const Vec3 dy = d * Vec3(Vec3::Unit(i).cross(limit.axis));
    const double du = dy.dot(limit.swing_axis), dv = dy.dot(second), dz = dy.dot(limit.axis);
    const double dsine = (yu * du + yv * dv) / sine;
    const double dangle = yz * dsine - sine * dz;
    const double dscale = (dangle - scale * dsine) / sine;
    const double da = -(dscale * yv + scale * dv), db = dscale * yu + scale * du;
    result.swing[i] = 2 * (a * da / (e0 * e0) + b * db / (e1 * e1));
  }
  return result;
}

Status check(std::span<const JointLimit> limits, int joints) {
  if (!limits.empty() && limits.size() != static_cast<std::size_t>(joints)) {
    return Error("limits-count",
                 fmt::format("limits of {} joints for a skeleton of {}", limits.size(), joints));
  }
  for (std::size_t j = 0; j < limits.size(); ++j) {
    const JointLimit& limit = limits[j];
    const auto wrong = [&](const char* what) {
      Error error("limits-value", what);
      error.joint = std::to_string(j);
      return error;
    };
    if (!(std::abs(limit.zero.norm() - 1) < 1e-6)) return wrong("zero is not a unit quaternion");
    if (!(std::abs(limit.axis.norm() - 1) < 1e-6) ||
        !(std::abs(limit.swing_axis.norm() - 1) < 1e-6)) {
      return wrong("an axis is not a unit vector");
    }
    if (limit.kind == JointLimit::Kind::cone &&
        !(std::abs(limit.axis.dot(limit.swing_axis)) < 1e-6)) {
      return wrong("the swing axis is not perpendicular to the twist axis");
    }
    if (!std::isfinite(limit.min_twist) || !std::isfinite(limit.max_twist) ||
        limit.min_twist > limit.max_twist) {
      return wrong("the twist's min is greater than its max");
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (!(limit.min_swing[i] >= -kPi - 1e-9 && limit.min_swing[i] <= 0 &&
            limit.max_swing[i] >= 0 && limit.max_swing[i] <= kPi + 1e-9)) {
        return wrong("a swing's range does not contain 0 or exceeds half a turn");
      }
    }
  }
  return {};
}

}  // namespace krok::ik
