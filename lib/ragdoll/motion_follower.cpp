#include "ragdoll/motion_follower.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/articulation_internal.h"
#include "ragdoll/body_joints.h"
#include "ragdoll/simulate.h"

namespace krok::ragdoll {

namespace {

constexpr double kGravity = 9.81;
constexpr double kHoldFrequency = 6;  // radians/s at strength 1/2
constexpr double kUpright = 2;        // times that frequency, for turning
constexpr double kHoldForce = 3;      // weights at strength 1/2
constexpr double kHoldArm = 0.5;      // metres
constexpr double kStraightOut = 3;    // times what holds a limb straight out
constexpr double kStrongest = 0.99;   // of a hold that is still a spring

// Of the bodies that a joint carries.
struct Load {
  double mass = 0;
  double inertia = 0;  // kg m^2 about the anchor, the largest of all axes
  double arm = 0;      // metres from the anchor to the centre of mass
};

bool is_foot(Role role) {
  return role == Role::left_foot || role == Role::right_foot;
}

bool is_below(const std::vector<Body>& bodies, int body, int top) {
  while (body > top) body = bodies[at(body)].parent;
  return body == top;
}

Load load_of(const std::vector<Body>& bodies, std::span<const BodyState> states, int top,
             const Vec3& anchor) {
  Load load;
  Mat3 whole = Mat3::Zero();
  Vec3 centre = Vec3::Zero();
  for (int b = top; b < static_cast<int>(bodies.size()); ++b) {
    if (!is_below(bodies, b, top)) continue;
    const Body& body = bodies[at(b)];
    const Mat3 axes = states[at(b)].to_world.orientation.toRotationMatrix();
    const Vec3 arm = states[at(b)].to_world.position - anchor;
    load.mass += body.mass;
    centre += body.mass * arm;
    whole += axes * moments_of_inertia(body).asDiagonal() * axes.transpose();
    whole += body.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  load.arm = centre.norm() / load.mass;
  load.inertia =
      Eigen::SelfAdjointEigenSolver<Mat3>(whole, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
  return load;
}

double whole_mass(const std::vector<Body>& bodies) {
  double mass = 0;
  for (const Body& body : bodies) mass += body.mass;
  return mass;
}

}  // namespace

double adult_torque(Role role) {
  switch (role) {
    case Role::left_upper_leg:
    case Role::right_upper_leg:
    case Role::left_lower_leg:
    case Role::right_lower_leg:
    case Role::hips:
    case Role::spine:
    case Role::chest:
      return 2.8;
    case Role::left_foot:
    case Role::right_foot:
      return 1.6;
    case Role::left_upper_arm:
    case Role::right_upper_arm:
      return 1.1;
    case Role::left_lower_arm:
    case Role::right_lower_arm:
      return 0.9;
    case Role::left_hand:
    case Role::right_hand:
      return 0.2;
    case Role::neck:
    case Role::head:
      return 0.4;
    default:
      return 0;
  }
}

void add_motors(const std::vector<Body>& bodies, const RoleMap& roles,
                std::span<const BodyState> states, std::vector<Joint>& joints) {
  const double mass = whole_mass(bodies);
  for (Joint& joint : joints) {
    const Body& body = bodies[at(joint.child)];
    if (body.mode != BodyMode::powered || !(body.strength > 0) ||
        joint.kind == JointKind::distance) {
      continue;
    }
    const Vec3 anchor = states[at(joint.child)].to_world * joint.in_child.position;
    Load load = load_of(bodies, states, joint.child, anchor);
    if (is_foot(roles.roles[at(body.joint)]) && body.parent > 0) {
      load.inertia = load_of(bodies, states, body.parent, anchor).inertia;
    }
    const double frequency = kMotorFrequency * body.strength;
    const double torque = adult_torque(roles.roles[at(body.joint)]);
    joint.motor = body.strength *
                  (torque > 0 ? torque * mass : kStraightOut * load.mass * kGravity * load.arm);
    joint.motor_stiffness = load.inertia * frequency * frequency;
    joint.motor_damping = 2 * load.inertia * frequency;
  }
}

Hold make_hold(const std::vector<Body>& bodies, std::span<const BodyState> states) {
  const double strength = std::clamp(bodies.front().strength, 0.0, kStrongest);
  const double ratio = strength / (1 - strength);
  const Load load = load_of(bodies, states, 0, states.front().to_world.position);
  const double frequency = kHoldFrequency * ratio;
  Hold hold;
  hold.stiffness = load.mass * frequency * frequency;
  hold.damping = 2 * load.mass * frequency;
  hold.max_force = kHoldForce * ratio * load.mass * kGravity;
  hold.turn_stiffness = load.inertia * kUpright * frequency * kUpright * frequency;
  hold.turn_damping = 2 * load.inertia * kUpright * frequency;
  hold.max_torque = kHoldArm * hold.max_force;
  return hold;
}

namespace {

// A range that includes a motion ends this far beyond it, so that following it meets no limit.
constexpr double kBeyond = 5 * kRadiansPerDegree;
// Swings near half a turn, where swing and twist jump: a motion that comes there has no limits.
constexpr double kNearOpposite = 150 * kRadiansPerDegree;
// The span of the differences that accelerations are from, seconds: captures jitter.
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
