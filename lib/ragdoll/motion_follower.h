#pragma once

#include <span>
#include <vector>

#include "core/index.h"
#include "ragdoll/bodies.h"
#include "ragdoll/joint.h"
#include "ragdoll/world.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Leads a world's animated and powered bodies along a motion.

namespace krok::ragdoll {

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
