#include "ragdoll/crouch_internal.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "ik/goal_motion.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/sample.h"

namespace krok::ragdoll {

namespace {

constexpr double kStands = 0.75;  // leg lengths, of the hips over the ground
// Of the crouch, in leg lengths: hips over the ankles and behind them, fingertips over the ground.
constexpr double kLow = 0.4, kBehind = 0.1, kTips = 0.04;
constexpr double kPitch = 55 * kRadiansPerDegree;  // of the trunk, forwards
// Seconds: hands and feet carry the body; it stands up, the hips after the hands; the motion
// begins.
constexpr double kCarries = 0.3, kStandsUp = 1.5, kHipsAfter = 0.2, kBegins = 0.5;
constexpr timeline::Easing kEasing{timeline::Curve::smoother, timeline::Ease::in_out};

double leg_length(const Skeleton& skeleton, const RoleMap& roles) {
  const LegRoles& leg = kLegRoles[0];
  const auto place = [&](Role role) { return skeleton.reference[at(roles.joint(role))].position; };
  return (place(leg.lower) - place(leg.upper)).norm() + (place(leg.foot) - place(leg.lower)).norm();
}

bool has_limbs(const RoleMap& roles) {
  const auto has = [&](Role role) { return roles.joint(role) >= 0; };
  return has(Role::hips) &&
         std::ranges::all_of(
             kLegRoles,
             [&](const LegRoles& l) { return has(l.upper) && has(l.lower) && has(l.foot); }) &&
         std::ranges::all_of(kArmRoles, [&](const ArmRoles& a) {
           return has(a.upper) && has(a.lower) && has(a.hand);
         });
}

// The first pose, lowered into the crouch over time.
class Crouch {
 public:
  Crouch(const Clip& motion, const RoleMap& roles) : roles_(roles), pose_(motion.joint_count()) {
    clip_.skeleton = motion.skeleton;
    clip_.rate = motion.rate;
    clip_.resize(static_cast<int>(std::ceil((kCarries + kStandsUp) * motion.rate)) + 1);
    motion.get_pose(0, pose_);
    for (int f = 0; f < clip_.frame_count(); ++f) clip_.set_pose(f, pose_);
    const Vec3 across = place(kLegRoles[0].upper) - place(kLegRoles[1].upper);
    left_ = Vec3(across.x(), 0, across.z()).stableNormalized();
    ahead_ = left_.cross(Vec3::UnitY());
    leg_ = leg_length(motion.skeleton, roles);
  }

  Result<Clip> lowered() {
    add_hips();
    for (std::size_t side = 0; side < kArmRoles.size(); ++side) add_hand(side);
    ik::GoalMotionOptions how;
    how.jobs = 1;
    how.solver.root_moves = true;
    how.solver.moving_joint = roles_.joint(Role::hips);
    how.solver.stiffness = ik::trunk_stiffness(clip_.skeleton, roles_, 0.5);
    how.solver.stiffness.resize(pose_.size(), 0.0);
    for (int j = how.solver.moving_joint; j > 0;) {
      j = clip_.skeleton.parents[at(j)];
      how.solver.stiffness[at(j)] = 1;
    }
    how.upright = roles_.joints(Role::head);
    for (const LegRoles& leg : kLegRoles) {
      const int upper = roles_.joint(leg.upper);
      how.held.push_back({upper, roles_.joint(leg.lower), roles_.joint(leg.foot),
                          pose_[at(upper)].orientation.conjugate() * left_});
    }
    auto made = ik::apply_goals(clip_, goals_, {}, how);
    if (!made) return made.error();
    return std::move(made->clip);
  }

 private:
  Vec3 place(Role role) const { return pose_[at(roles_.joint(role))].position; }

  // From where the pose has it to where the crouch has it.
  void add(ik::Goal goal, const Transform& to, double after) {
    ik::KeyedGoal keyed;
    goal.axis = Vec3::UnitZ();
    keyed.goal = goal;
    const Transform& from = pose_[at(goal.joint)];
    keyed.keys = {{0, from * goal.point, from.orientation, kEasing},
                  {kStandsUp - after, to.position, to.orientation, kEasing}};
    keyed.from = 0;
    keyed.to = clip_.duration() + 1;
    keyed.fade_in = keyed.fade_out = 0;
    goals_.push_back(std::move(keyed));
  }

  void add_hips() {
    ik::Goal goal;
    goal.kind = ik::Goal::Kind::pose;
    goal.joint = roles_.joint(Role::hips);
    goal.depth = 1;
    hips_ = 0.5 * (place(kLegRoles[0].foot) + place(kLegRoles[1].foot)) - kBehind * leg_ * ahead_ +
            kLow * leg_ * Vec3::UnitY();
    const Quat pitch(Eigen::AngleAxisd(kPitch, left_));
    // Of the middle between the thighs.
    const Vec3 middle = 0.5 * (place(kLegRoles[0].upper) + place(kLegRoles[1].upper));
    const Transform& now = pose_[at(goal.joint)];
    add(goal, {hips_ + pitch * (now.position - middle), (pitch * now.orientation).normalized()},
        kHipsAfter);
  }

  void add_hand(std::size_t side) {
    const ArmRoles& arm = kArmRoles[side];
    ik::Goal goal;
    goal.kind = ik::Goal::Kind::position;
    goal.joint = roles_.joint(arm.hand);
    const Skeleton& skeleton = clip_.skeleton;
    const std::vector<std::uint8_t> below = subtree(skeleton, goal.joint);
    for (std::size_t j = 0; j < below.size(); ++j) {
      if (below[j] == 0) continue;
      const Vec3 tip =
          skeleton.reference[at(goal.joint)].inverse() * skeleton.reference[j].position;
      if (tip.norm() > goal.point.norm()) goal.point = tip;
    }
    // All joints below what carries a leg.
    for (int j = goal.joint; j >= 0; j = skeleton.parents[at(j)], ++goal.depth) {
      const std::vector<std::uint8_t> carried = subtree(skeleton, j);
      if (carried[at(roles_.joint(kLegRoles[0].upper))] != 0) break;
    }
    const Vec3 shoulder = place(arm.upper),
               middle = 0.5 * (place(kArmRoles[0].upper) + place(kArmRoles[1].upper));
    const double trunk = (middle - place(Role::hips)).norm();
    const Vec3 beside = left_ * left_.dot(shoulder - middle);
    Vec3 to = hips_ + ahead_ * (std::sin(kPitch) * trunk) + beside;
    to.y() = kTips * leg_;
    add(goal, {to, Quat::Identity()}, 0);
  }

  const RoleMap& roles_;
  std::vector<Transform> pose_;
  Clip clip_;
  Vec3 left_, ahead_, hips_;
  double leg_ = 0;
  std::vector<ik::KeyedGoal> goals_;
};

}  // namespace

bool begins_standing(const Clip& motion, const RoleMap& roles) {
  if (!has_limbs(roles) || motion.frame_count() == 0) return false;
  const double height = motion.frame_positions(0)[at(roles.joint(Role::hips))].y();
  return height > kStands * leg_length(motion.skeleton, roles);
}

Result<Clip> begun_in_crouch(const Clip& motion, const RoleMap& roles) {
  if (!has_limbs(roles) || motion.frame_count() == 0) return motion;
  auto lowered = Crouch(motion, roles).lowered();
  if (!lowered) return lowered.error();
  const int rising = lowered->frame_count() - 1;
  // Its first half second takes one, so that it begins from rest.
  const int slow = std::min(static_cast<int>(kBegins * motion.rate), motion.frame_count() - 1);
  const int half = slow / 2;
  Clip clip;
  clip.skeleton = motion.skeleton;
  clip.rate = motion.rate;
  clip.provenance = motion.provenance;
  clip.resize(rising + half + motion.frame_count());
  std::vector<Transform> pose(motion.skeleton.names.size()), scratch(3 * pose.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    if (f < rising) {
      lowered->get_pose(rising - f, pose);
    } else {
      const int since = f - rising;
      const double u = static_cast<double>(since) / std::max(1, 2 * half);
      // After a speed that grows smoothly from 0.
      const double frames = u < 1 ? 2 * half * u * u * u * (1 - 0.5 * u) : since - half;
      sample(motion, frames / motion.rate, pose, scratch);
    }
    clip.set_pose(f, pose);
  }
  return clip;
}

}  // namespace krok::ragdoll
