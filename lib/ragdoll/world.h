#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "ragdoll/bodies.h"
#include "ragdoll/joint.h"

// Rigid bodies that move by Newton's laws, with joints and static surroundings.

namespace krok::ragdoll {

// Pose and speed of a body's centre of mass; metres, seconds, world.
struct BodyState {
  Transform to_world;
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();  // radians/s
};

struct WorldOptions {
  Vec3 gravity = Vec3(0, -9.81, 0);  // m/s^2
  double friction = 0.7;             // Coulomb's, between bodies and surroundings, >= 0
  double restitution = 0;            // 0 to 1
  int substeps = 1;     // parts of a step, >= 1; contacts are looked for once in each step
  int iterations = 12;  // most sweeps over contacts and limits in each part, >= 1
};

// A static surface.
struct Surroundings {
  bool level = false;                          // an endless plane, solid below
  double height = 0;                           // of the plane, metres
  std::vector<std::array<Vec3, 3>> triangles;  // of either side
};

// A spring and damper between a body and a pose outside that moves; metres, newtons, radians,
// world. Each part gives at most its force or torque.
struct Hold {
  Transform target;  // of the centre of mass, where it is after the next step
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  double stiffness = 0, damping = 0, max_force = 0;             // N/m, N s/m, N; >= 0
  double turn_stiffness = 0, turn_damping = 0, max_torque = 0;  // N m/rad, N m s/rad, N m
  // Besides, whatever the pose: a force, and a torque about the centre (N, N m).
  Vec3 support = Vec3::Zero(), support_torque = Vec3::Zero();
};

// The state of the contacts and joints after a step.
struct WorldMeasures {
  double joint_gap = 0;     // metres: the largest distance between anchors that should coincide
  double limit_excess = 0;  // radians: the largest angle beyond a hard limit
  double penetration = 0;   // metres: how deep a body is in the surroundings
  int contacts = 0;         // points at which bodies touch the surroundings
};

class World {
 public:
  static constexpr double kStep = 1.0 / 240;  // seconds

  World(const WorldOptions& options, const Surroundings& surroundings);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // `joints` refer to the bodies. Bodies that a joint ties do not collide, nor do those that
  // overlap at the start. Animated bodies (Body::mode) move by lead() alone, whatever they touch;
  // the joints of powered ones are as `joints` has them. Called once. Codes ragdoll-value for
  // values out of the ranges above, ragdoll-mode for an animated body below one that is not.
  Status add(std::span<const Body> bodies, std::span<const BodyState> states,
             std::span<const Joint> joints);

  // Advances by kStep, in `substeps` equal parts, or more where something spins fast.
  void step();

  // An impulse (N s, world) at a body's centre of mass.
  void push(int body, const Vec3& impulse);

  // Sets the target of a joint's motor.
  void set_motor(int joint, const Quat& target, const Vec3& target_speed);

  // The pose of an animated body after the next step; without a call it keeps its speed.
  void lead(int body, const Transform& to_world);

  // Where a joint that does not slide has its anchor in the parent's frame after the next step.
  void move_anchor(int joint, const Vec3& in_parent);

  // Holds a body that no joint ties to one above, from the next step on.
  void hold(int body, const Hold& hold);

  BodyState state(int body) const;
  WorldMeasures measures() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace krok::ragdoll
