#pragma once

#include <functional>
#include <vector>

#include "timeline/base_motion.h"

// Values with velocities and accelerations where two motions join, and the curves that blend from
// one to the other.

namespace krok::timeline {

// First and second derivatives of a value: value + velocity s + acceleration s^2 / 2. Seconds.
struct Rates {
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  Vec3 at(double s) const { return s * velocity + 0.5 * s * s * acceleration; }
};

// Finite differences of a curve that is 0 at time 0, `one` at `step` and `two` at 2 `step`; `step`
// may be negative. `known` samples are used: 2, 1 (velocity only) or 0 (all zero).
Rates rates_of(const Vec3& one, const Vec3& two, double step, int known);

// A pose and its derivatives.
struct ActorState {
  ActorPose pose;
  Rates place;                   // x, z, heading
  std::vector<Rates> rotations;  // [joints], rotation vectors applied from the left
  std::vector<Rates> positions;  // [joints]
};

// From `pose_at(0)` and up to two more poses `step` seconds apart (negative: earlier); `known` is
// the number of further poses.
ActorState actor_state(const std::function<ActorPose(int)>& pose_at, double step, int known);

// The velocity of a rotation vector v for which exp(v) has the angular velocity `rate` in the fixed
// frame: the inverse of the left Jacobian of the exponential map (Chirikjian, Stochastic Models,
// Information Theory, and Lie Groups, vol. 2, sec. 10.7).
Vec3 vector_velocity(const Vec3& v, const Vec3& rate);

// An offset that decays to zero: given value, velocity and acceleration at the start, all zero at
// the end. The quintic of Bollo, Inertialization: high-performance animation transitions in Gears
// of War, GDC 2018.
class Decay {
 public:
  Decay() = default;
  // `guard` prevents overshoot past zero: if the velocity points towards zero the duration is
  // shortened, to a third at least, and the acceleration along the offset is limited with Bollo's
  // bound. Bollo zeroes a velocity that points away from zero, which causes a velocity jump; here
  // it is kept.
  Decay(const Vec3& value, const Rates& rates, double duration, bool guard);

  Vec3 at(double time) const;

 private:
  Vec3 value_ = Vec3::Zero();
  Rates rates_;
  double duration_ = 0;
};

// The offset from `to` to `from`, both moving, as a rotation vector applied to `to` from the left.
struct RotationOffset {
  Vec3 value = Vec3::Zero();
  Rates rates;
};
RotationOffset rotation_offset(const Quat& from, const Rates& from_rates, const Quat& to,
                               const Rates& to_rates);

}  // namespace krok::timeline
