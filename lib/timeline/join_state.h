#pragma once

#include <functional>
#include <vector>

#include "timeline/actor_pose.h"

// Values with velocities and accelerations where two motions join, and the curves that go over from
// one to the other.

namespace krok::timeline {

// How something moves at a moment: value + velocity s + acceleration s^2 / 2. Seconds.
struct Rates {
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  Vec3 at(double s) const { return s * velocity + 0.5 * s * s * acceleration; }
};

// Through nothing at 0, `one` at `step` and `two` at 2 `step`, which may be negative; with
// `known` 1 through the first alone, with 0 at rest.
Rates rates_of(const Vec3& one, const Vec3& two, double step, int known);

// A figure at a moment and how all of it moves.
struct ActorState {
  ActorPose pose;
  Rates place;                   // x, z, heading
  std::vector<Rates> rotations;  // [joints], rotation vectors put on from the left
  std::vector<Rates> positions;  // [joints]
};

// From the pose at the moment and up to two more, `step` seconds apart (negative: before it);
// `pose_at(k)` gives the kth, `known` is how many there are beside the first.
ActorState actor_state(const std::function<ActorPose(int)>& pose_at, double step, int known);

// The velocity of a rotation vector v with which exp(v) turns at `rate`, seen from outside: the
// inverse of the left Jacobian of the exponential map (Chirikjian, Stochastic Models, Information
// Theory, and Lie Groups, vol. 2, sec. 10.7).
Vec3 vector_velocity(const Vec3& v, const Vec3& rate);

// An offset that decays to nothing, with value, velocity and acceleration as at the beginning and
// none of them at the end: the quintic of Bollo, Inertialization: high-performance animation
// transitions in Gears of War, GDC 2018.
class Decay {
 public:
  Decay() = default;
  // `guard` keeps the offset from going beyond nothing: where the velocity leads home sooner the
  // time is shortened, to a third at least, and of the acceleration along the offset no more is
  // left than Bollo's lets it fall evenly. Bollo drops a velocity that leads away, which would be a
  // jump; here it stays.
  Decay(const Vec3& value, const Rates& rates, double duration, bool guard);

  Vec3 at(double time) const;

 private:
  Vec3 value_ = Vec3::Zero();
  Rates rates_;
  double duration_ = 0;
};

// What is missing from one rotation to another, both of which move, as a rotation vector put on
// the `to` from the left.
struct RotationOffset {
  Vec3 value = Vec3::Zero();
  Rates rates;
};
RotationOffset rotation_offset(const Quat& from, const Rates& from_rates, const Quat& to,
                               const Rates& to_rates);

}  // namespace krok::timeline
