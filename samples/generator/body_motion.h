#pragma once

#include <array>
#include <span>
#include <vector>

#include "math/transform.h"
#include "samples/generator/curves.h"
#include "samples/generator/foot_motion.h"

// Full-body motion: pelvis, trunk, head and arms from published gait curves, legs by two-bone
// inverse kinematics between pelvis and feet.

namespace krok::samples {

class BodyMotion {
 public:
  BodyMotion(const WalkOptions& options, const Actor& actor, const FootPlan& plan);

  // joint_to_world of all joints of actor.skeleton, shape [joints].
  void pose(double time, std::span<Transform> joint_to_world) const;

  const FootMotion& foot(Side side) const { return feet_[static_cast<std::size_t>(side)]; }

 private:
  Transform pelvis_without_height(double time) const;
  Transform pelvis(double time) const;
  double left_phase(double time) const;
  void plan_height();
  double level_height(double time) const;
  double stairs_height(double time) const;
  double highest(double time) const;
  void pose_trunk(double time, std::span<Transform> world) const;
  void pose_arm(Side side, double time, std::span<Transform> world) const;
  void pose_leg(Side side, double time, std::span<Transform> world) const;

  const WalkOptions options_;
  const Actor actor_;
  const FootPlan plan_;
  std::array<FootMotion, 2> feet_;  // [Side]
  Spline<Vec3> path_;               // the middle between the feet, along the walk
  Spline<double> heading_;
  Spline<double> activity_;  // step length relative to an ordinary step, 0 when standing
  Spline<double> height_;    // of the pelvis, computed from the legs
};

}  // namespace krok::samples
