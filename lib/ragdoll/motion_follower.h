#pragma once

#include <span>
#include <vector>

#include "core/index.h"
#include "ragdoll/bodies.h"
#include "ragdoll/joint.h"
#include "ragdoll/world.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Motors that follow a motion, in strength like an adult's muscles.

namespace krok::ragdoll {

// A powered body of strength 1 follows with this frequency, radians/s: what is off by an angle
// comes back, critically damped, to a tenth of it within 4 / kMotorFrequency seconds. With strength
// s the frequency is s times that.
inline constexpr double kMotorFrequency = 60;

// The largest torque, N m for each kilogram of the whole body, of an adult at the joint of a role;
// 0 for roles without one. Legs: the peak isometric torques of Anderson, Madigan and Nussbaum
// ("Maximum voluntary joint torque as a function of joint angle and angular velocity", Journal of
// Biomechanics 40, 2007), the stronger direction; arms: those of Holzbaur, Delp, Gold and Murray
// ("Moment-generating capacity of upper limb muscles in healthy adults", Journal of Biomechanics
// 40, 2007); both rounded, for 75 kg and 1.75 m. Trunk and neck are set to the hip's and to a third
// of the shoulder's, as they carry about as much.
double adult_torque(Role role);

// Gives the joints of powered bodies their motors (Joint::motor ...), critically damped against the
// inertia below the joint in `states`; that of a foot against shank and foot, as the shank swings
// over it while it stands. A joint at a role without a torque gets three times what
// carries its bodies held straight out. Joints of other bodies stay as they are.
void add_motors(const std::vector<Body>& bodies, const RoleMap& roles,
                std::span<const BodyState> states, std::vector<Joint>& joints);

// The spring that holds a powered root body: critically damped against the whole body's mass and
// inertia, with a frequency of 6 s / (1 - s) radians/s for strength s, which goes from free to as
// animated (and stays at 0.99), and of twice that for turning, so that feet that drag do not tip
// the body over. It gives at most 3 s / (1 - s) times the body's weight (of a torque: half a metre
// of that). Without target and support.
Hold make_hold(const std::vector<Body>& bodies, std::span<const BodyState> states);

// Leads a world's animated and powered bodies along a motion.

class MotionFollower {
 public:
  // The motion and the bodies outlive it. `origin` is where the simulation's world has its own.
  MotionFollower(const Clip& motion, const std::vector<Body>& bodies, const Vec3& origin);

  // Whether any body is not simulated.
  bool follows() const { return follows_; }

  // Whether what a body carries without a body (collar bones, fingers) moves on with the motion.
  bool plays_on(int body) const { return bodies_[at(body)].mode != BodyMode::simulated; }

  // Before World::add(): gives powered joints their motors, makes their hinges turn as far about
  // other axes as the motion does from `begin` to `end` (seconds), and widens their ranges to
  // include it. `states` are the bodies at the begin.
  void prepare(double begin, double end, const RoleMap& roles, std::span<const BodyState> states,
               std::vector<Joint>& joints);

  // Before each step: where all should be after it, at `time` of the motion. Gravity: m/s^2.
  void lead(World& world, double time, const Vec3& gravity);

  // The motion at the time of the last lead() (before: of prepare()), joint_to_world.
  std::span<const Transform> pose() const { return now_; }

 private:
  Transform body_at(const std::vector<Transform>& pose, int body) const;
  Quat turn_at(const std::vector<Transform>& pose, const Joint& joint) const;
  Vec3 anchor_at(const std::vector<Transform>& pose, const Joint& joint) const;
  void free_hinge(Joint& joint) const;
  void include_motion(Joint& joint, std::span<const Quat> turns) const;
  void lead_root(World& world, double time, const Vec3& gravity) const;

  const Clip& motion_;
  const std::vector<Body>& bodies_;
  Vec3 origin_;
  bool follows_ = false;
  std::vector<Joint> joints_;
  std::vector<Vec3> first_anchors_;  // shape [joints]
  Hold hold_;
  double mass_ = 0;
  std::vector<Transform> now_, before_, after_;
};

}  // namespace krok::ragdoll
