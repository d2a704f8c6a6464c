#include "camera/look_at.h"

#include <cassert>
#include <cmath>
#include <optional>

#include "math/euler.h"
#include "math/quaternion.h"

namespace krok {

namespace {

const double kSineAtVertical = std::sin(0.1 * kRadiansPerDegree);

// The unit direction from eye to target, if defined.
std::optional<Vec3> direction(const Vec3& eye, const Vec3& target) {
  const Vec3 way = target - eye;
  const double length = way.stableNorm();
  // Closer than this, rounding errors decide the direction.
  const double least = 1e-12 * (eye.stableNorm() + target.stableNorm());
  if (!(length > least) || !std::isfinite(length)) return std::nullopt;
  return Vec3(way / length);
}

bool is_vertical(const Vec3& forward) {
  return std::hypot(forward.x(), forward.z()) < kSineAtVertical;
}

Quat level(const Vec3& forward) {
  Mat3 axes;
  axes.col(0) = forward.cross(Vec3::UnitY()).normalized();
  axes.col(1) = axes.col(0).cross(forward);
  axes.col(2) = -forward;
  return Quat(axes).normalized();
}

Quat turned_to(const Vec3& forward, const Quat& before) {
  return normalized_or_identity(shortest_arc(before * Vec3(-Vec3::UnitZ()), forward) * before);
}

// The `before` of the first time, for a camera that starts out looking straight up or down.
Quat first_past(std::span<const Vec3> eyes, std::span<const Vec3> targets) {
  std::optional<Vec3> vertical;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    const auto forward = direction(eyes[i], targets[i]);
    if (!forward) continue;
    if (!is_vertical(*forward)) return level(*forward);
    if (!vertical) vertical = forward;
  }
  if (!vertical) return Quat::Identity();
  return looking_from(0, vertical->y() < 0 ? kPi / 2 : -kPi / 2);
}

}  // namespace

Quat look_at(const Vec3& eye, const Vec3& target, const Quat& before) {
  const auto forward = direction(eye, target);
  if (!forward) return before;
  return is_vertical(*forward) ? turned_to(*forward, before) : level(*forward);
}

std::vector<Quat> look_at(std::span<const Vec3> eyes, std::span<const Vec3> targets) {
  assert(eyes.size() == targets.size());
  std::vector<Quat> orientations;
  orientations.reserve(eyes.size());
  Quat before = first_past(eyes, targets);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    before = look_at(eyes[i], targets[i], before);
    orientations.push_back(before);
  }
  return orientations;
}

Quat looking_from(double azimuth, double elevation) {
  return axis_rotation(Axis::y, azimuth) * axis_rotation(Axis::x, -elevation);
}

Quat rolled(const Quat& orientation, double angle) {
  return orientation * axis_rotation(Axis::z, -angle);
}

}  // namespace krok
