#include "ragdoll/motion_follower.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/body_joints.h"
#include "ragdoll/motors.h"
#include "ragdoll/simulate.h"

namespace krok::ragdoll {

namespace {

// A range that includes a motion ends this far beyond it, so that following it meets no limit.
constexpr double kBeyond = 5 * kRadiansPerDegree;
// Swings near half a turn, where swing and twist jump: a motion that comes there has no limits.
constexpr double kNearOpposite = 150 * kRadiansPerDegree;
// The span of the differences that accelerations are from, seconds: captures tremble.
constexpr double kSmooth = 0.05;
// The share of the body's weight that a hold carries. The legs carry the rest; with more, feet that
// a capture has above the ground, or in it, would brake the walk.
constexpr double kCarried = 0.95;

}  // namespace

MotionFollower::MotionFollower(const Clip& motion, const std::vector<Body>& bodies,
                               const Vec3& origin)
    : motion_(motion), bodies_(bodies), origin_(origin) {
  for (const Body& body : bodies_) {
    follows_ = follows_ || body.mode != BodyMode::simulated;
    mass_ += body.mass;
  }
}

Transform MotionFollower::body_at(const std::vector<Transform>& pose, int body) const {
  if (body < 0) return {};
  Transform to_world = pose[at(bodies_[at(body)].joint)] * bodies_[at(body)].to_joint;
  to_world.position -= origin_;
  return to_world;
}

// Of the child's frame in the parent's.
Quat MotionFollower::turn_at(const std::vector<Transform>& pose, const Joint& joint) const {
  const Quat parent = body_at(pose, joint.parent).orientation * joint.in_parent.orientation;
  const Quat child = body_at(pose, joint.child).orientation * joint.in_child.orientation;
  return (parent.conjugate() * child).normalized();
}

// The child's skeleton joint in the parent.
Vec3 MotionFollower::anchor_at(const std::vector<Transform>& pose, const Joint& joint) const {
  const Vec3 place = pose[at(bodies_[at(joint.child)].joint)].position - origin_;
  return body_at(pose, joint.parent).inverse() * place;
}

// A hinge becomes a cone about the middle of its range, which other axes are added to.
void MotionFollower::free_hinge(Joint& joint) const {
  const double min = std::max(joint.range.min, -kPi), max = std::min(joint.range.max, kPi);
  joint.kind = JointKind::spherical;
  joint.turn = {};
  joint.turn.kind = ik::JointLimit::Kind::cone;
  joint.turn.zero = from_rotation_vector(Vec3(0.5 * (min + max), 0, 0));
  joint.turn.min_twist = joint.turn.max_twist = 0;
  joint.turn.min_swing = {0.5 * (min - max), 0};
  joint.turn.max_swing = {0.5 * (max - min), 0};
}

void MotionFollower::include_motion(Joint& joint, std::span<const Quat> turns) const {
  ik::JointLimit& turn = joint.turn;
  if (joint.kind == JointKind::revolute) free_hinge(joint);
  if (turn.kind != ik::JointLimit::Kind::cone) return;
  // First a half axis where there is none, so that the ellipse need not grow in all directions.
  for (const Quat& now : turns) {
    const ik::LimitAngles angles = ik::measure(turn, now);
    if (std::hypot(angles.swing[0], angles.swing[1]) > kNearOpposite) {
      turn = {};
      return;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      turn.min_swing[i] = std::max(-kPi, std::min(turn.min_swing[i], angles.swing[i] - kBeyond));
      turn.max_swing[i] = std::min(kPi, std::max(turn.max_swing[i], angles.swing[i] + kBeyond));
    }
    turn.min_twist = std::max(-kPi, std::min(turn.min_twist, angles.twist - kBeyond));
    turn.max_twist = std::min(kPi, std::max(turn.max_twist, angles.twist + kBeyond));
  }
  for (const Quat& now : turns) include_turn(turn, now);
}

void MotionFollower::prepare(double begin, double end, const RoleMap& roles,
                             std::span<const BodyState> states, std::vector<Joint>& joints) {
  now_ = pose_at(motion_, begin);
  if (!follows_) return;
  std::vector<std::vector<Quat>> turns(joints.size());
  const auto powered = [&](const Joint& joint) {
    const Body& body = bodies_[at(joint.child)];
    return body.mode == BodyMode::powered && body.strength > 0 && joint.kind != JointKind::distance;
  };
  const int first = static_cast<int>(std::floor(begin * motion_.rate));
  const int last =
      std::min(motion_.frame_count() - 1, static_cast<int>(std::ceil(end * motion_.rate)));
  std::vector<Transform> pose(now_.size());
  for (int frame = first; frame <= last; ++frame) {
    motion_.get_pose(frame, pose);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (powered(joints[j])) turns[j].push_back(turn_at(pose, joints[j]));
    }
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (powered(joints[j])) include_motion(joints[j], turns[j]);
  }
  add_motors(bodies_, roles, states, joints);
  hold_ = make_hold(bodies_, states);
  joints_ = joints;
  for (const Joint& joint : joints_) first_anchors_.push_back(anchor_at(now_, joint));
}

void MotionFollower::lead_root(World& world, double time, const Vec3& gravity) const {
  const Body& root = bodies_.front();
  const Transform target = body_at(now_, 0);
  if (root.mode == BodyMode::animated) world.lead(0, target);
  if (root.mode != BodyMode::powered || !(root.strength > 0)) return;
  const Transform before = body_at(before_, 0), after = body_at(after_, 0);
  const double span = std::min(time + 0.5 / motion_.rate, motion_.duration()) -
                      std::max(time - 0.5 / motion_.rate, 0.0);
  Hold hold = hold_;
  hold.target = target;
  if (span > 0) {
    hold.velocity = (after.position - before.position) / span;
    hold.spin = rotation_vector(after.orientation * before.orientation.conjugate()) / span;
  }
  Vec3 acceleration = Vec3::Zero();
  if (time >= kSmooth && time + kSmooth <= motion_.duration()) {
    const Vec3 sum = body_at(pose_at(motion_, time - kSmooth), 0).position +
                     body_at(pose_at(motion_, time + kSmooth), 0).position;
    acceleration = (sum - 2 * target.position) / (kSmooth * kSmooth);
  }
  Vec3 centre = Vec3::Zero();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    centre += bodies_[b].mass / mass_ * world.state(static_cast<int>(b)).to_world.position;
  }
  // At the centre of mass, so that it does not turn what bends.
  hold.support = mass_ * (acceleration - kCarried * gravity);
  hold.support_torque = (centre - world.state(0).to_world.position).cross(hold.support);
  world.hold(0, hold);
}

void MotionFollower::lead(World& world, double time, const Vec3& gravity) {
  if (!follows_) return;
  const double half = 0.5 / motion_.rate;
  const double first = std::max(0.0, time - half), last = std::min(motion_.duration(), time + half);
  now_ = pose_at(motion_, time);
  before_ = pose_at(motion_, first);
  after_ = pose_at(motion_, last);
  lead_root(world, time, gravity);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const int number = static_cast<int>(j);
    const Body& body = bodies_[at(joint.child)];
    if (body.mode == BodyMode::animated) {
      if (joint.kind != JointKind::distance) world.lead(joint.child, body_at(now_, joint.child));
      continue;
    }
    if (joint.parent >= 0 && plays_on(joint.parent) && !can_slide(joint)) {
      world.move_anchor(number,
                        joint.in_parent.position + anchor_at(now_, joint) - first_anchors_[j]);
    }
    if (joint.motor <= 0) continue;
    const Quat change = turn_at(after_, joint) * turn_at(before_, joint).conjugate();
    world.set_motor(
        number, turn_at(now_, joint),
        last > first ? Vec3(rotation_vector(change) / (last - first)) : Vec3(Vec3::Zero()));
  }
}

}  // namespace krok::ragdoll
