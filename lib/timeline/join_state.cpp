#include "timeline/join_state.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok::timeline {

namespace {

constexpr double kNothing = 1e-9;

// The rotation vector equivalent to v that is closest to `near`.
Vec3 closest_vector(const Vec3& v, const Vec3& near) {
  const double angle = v.norm();
  if (angle < kNothing) return v;
  const Vec3 other = v * (1 - 2 * kPi / angle);
  return (other - near).squaredNorm() < (v - near).squaredNorm() ? other : v;
}

// Shortens the duration and limits the acceleration so that the offset does not pass zero.
void keep_from_passing(const Vec3& value, Rates& rates, double& duration) {
  const double far = value.norm();
  const Vec3 away = far > kNothing ? Vec3(value / far) : Vec3(Vec3::Zero());
  const double velocity = rates.velocity.dot(away);
  if (velocity < 0) duration = std::clamp(-5 * far / velocity, duration / 3, duration);
  const double square = duration * duration;
  const double most = (20 * far + 8 * rates.velocity.norm() * duration) / square;
  const double least = std::max(0.0, (-8 * velocity * duration - 20 * far) / square);
  const double along = rates.acceleration.dot(away);
  Vec3 across = rates.acceleration - along * away;
  if (across.norm() > most) across *= most / across.norm();
  rates.acceleration = across;
  if (far > kNothing) rates.acceleration += std::clamp(along, least, std::max(least, most)) * away;
}

}  // namespace

Rates rates_of(const Vec3& one, const Vec3& two, double step, int known) {
  if (known <= 0 || step == 0) return {};
  if (known == 1) return {one / step, Vec3::Zero()};
  return {(4 * one - two) / (2 * step), (two - 2 * one) / (step * step)};
}

ActorState actor_state(const std::function<ActorPose(int)>& pose_at, double step, int known) {
  ActorState state;
  state.pose = pose_at(0);
  const ActorPose one = known > 0 ? pose_at(1) : state.pose;
  const ActorPose two = known > 1 ? pose_at(2) : one;
  state.place = rates_of(difference(state.pose.place, one.place),
                         difference(state.pose.place, two.place), step, known);
  for (std::size_t j = 0; j < state.pose.local.size(); ++j) {
    const Transform& at = state.pose.local[j];
    const auto turned = [&](const ActorPose& other) {
      return rotation_vector(other.local[j].orientation * at.orientation.conjugate());
    };
    state.rotations.push_back(rates_of(turned(one), turned(two), step, known));
    state.positions.push_back(rates_of(one.local[j].position - at.position,
                                       two.local[j].position - at.position, step, known));
  }
  return state;
}

Vec3 vector_velocity(const Vec3& v, const Vec3& rate) {
  const double angle = v.norm();
  const double factor =
      angle < 1e-4 ? 1.0 / 12 : 1 / (angle * angle) - 0.5 / (angle * std::tan(0.5 * angle));
  return rate - 0.5 * v.cross(rate) + factor * v.cross(v.cross(rate));
}

Decay::Decay(const Vec3& value, const Rates& rates, double duration, bool guard)
    : value_(value), rates_(rates), duration_(duration) {
  if (guard && duration_ > 0) keep_from_passing(value_, rates_, duration_);
}

Vec3 Decay::at(double time) const {
  if (!(time < duration_)) return Vec3::Zero();
  const double t = std::max(time, 0.0), d = duration_;
  const Vec3 x = value_, v = rates_.velocity * d, a = rates_.acceleration * (d * d);
  const double u = t / d;
  const Vec3 third = -0.5 * (3 * a + 12 * v + 20 * x);
  const Vec3 fourth = 0.5 * (3 * a + 16 * v + 30 * x);
  const Vec3 fifth = -0.5 * (a + 6 * v + 12 * x);
  return x + u * (v + u * (0.5 * a + u * (third + u * (fourth + u * fifth))));
}

RotationOffset rotation_offset(const Quat& from, const Rates& from_rates, const Quat& to,
                               const Rates& to_rates) {
  const auto offset_at = [&](double s) {
    const Quat a = from_rotation_vector(from_rates.at(s)) * from;
    const Quat b = from_rotation_vector(to_rates.at(s)) * to;
    return rotation_vector(a * b.conjugate());
  };
  // Central differences: the step is small compared with joint motion and large compared with
  // rounding errors.
  constexpr double kStep = 1e-3;
  RotationOffset offset;
  offset.value = offset_at(0);
  const Vec3 before = closest_vector(offset_at(-kStep), offset.value);
  const Vec3 after = closest_vector(offset_at(kStep), offset.value);
  offset.rates.velocity = (after - before) / (2 * kStep);
  offset.rates.acceleration = (after - 2 * offset.value + before) / (kStep * kStep);
  return offset;
}

}  // namespace krok::timeline
