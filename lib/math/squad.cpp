#include "math/squad.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "math/quaternion.h"

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

}  // namespace krok
