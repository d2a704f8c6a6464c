#include "ragdoll/joint_rules.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/body_joints.h"
#include "ragdoll/joint.h"

namespace krok::ragdoll {

std::string_view joint_kind_name(JointKind kind) {
  switch (kind) {
    case JointKind::fixed:
      return "fixed";
    case JointKind::distance:
      return "distance";
    case JointKind::spherical:
      return "spherical";
    case JointKind::revolute:
      return "revolute";
    case JointKind::prismatic:
      return "prismatic";
    case JointKind::six_dof:
      return "six_dof";
  }
  return "";
}

bool can_slide(const Joint& joint) {
  return joint.kind == JointKind::prismatic || joint.kind == JointKind::distance ||
         (joint.kind == JointKind::six_dof &&
          std::ranges::any_of(joint.slide, [](const Range& r) { return r.min != r.max; }));
}

namespace {

// A pose may miss a rule by this much before it changes the rule: the rounding of angles.
constexpr double kSameAngle = 1e-7, kSameLength = 1e-9;

double rounded_angle(double radians) {
  if (!std::isfinite(radians)) return radians;
  return std::round(radians / kRadiansPerDegree * 1e6) / 1e6 * kRadiansPerDegree;
}

void round_angles(JointRule& rule) {
  if (rule.kind == JointKind::revolute) {
    rule.range = {rounded_angle(rule.range.min), rounded_angle(rule.range.max)};
  }
  ik::JointLimit& turn = rule.turn;
  for (std::size_t i = 0; i < 2; ++i) {
    turn.min_swing[i] = std::max(-kPi, rounded_angle(turn.min_swing[i]));
    turn.max_swing[i] = std::min(kPi, rounded_angle(turn.max_swing[i]));
  }
  turn.min_twist = std::max(-kPi, rounded_angle(turn.min_twist));
  turn.max_twist = std::min(kPi, rounded_angle(turn.max_twist));
}

JointRule rule_of(const Joint& joint, const std::vector<Body>& bodies) {
  JointRule rule;
  static_cast<JointConstraint&>(rule) = joint;
  const Body& child = bodies[at(joint.child)];
  const Quat in_child = child.to_joint.orientation * joint.in_child.orientation;
  rule.anchor = child.to_joint * joint.in_child.position;
  // What is made is at the skeleton's joint itself.
  if (rule.anchor.norm() < kSameLength) rule.anchor.setZero();
  Quat in_parent = joint.in_parent.orientation;
  if (joint.parent >= 0) in_parent = bodies[at(joint.parent)].to_joint.orientation * in_parent;
  if (rule.kind == JointKind::revolute || rule.kind == JointKind::prismatic) {
    rule.axis = (in_child * Vec3(Vec3::UnitX())).normalized();
    rule.zero = (in_parent * in_child.conjugate()).normalized();
  }
  return rule;
}

// The angle that a hinge has in a pose, and its turn about the other axes.
struct HingeAngle {
  double angle = 0;
  Quat off = Quat::Identity();
};

HingeAngle hinge_angle(const JointRule& rule, const Quat& child_to_parent) {
  const Quat turn = rule.zero.conjugate() * child_to_parent;
  const double along = turn.vec().dot(rule.axis);
  HingeAngle found;
  double angle = 2 * std::atan2(along, turn.w());
  if (std::isfinite(rule.range.min + rule.range.max)) {
    const double middle = 0.5 * (rule.range.min + rule.range.max);
    angle -= 2 * kPi * std::round((angle - middle) / (2 * kPi));
  }
  found.angle = angle;
  found.off = turn * from_rotation_vector(-angle * rule.axis);
  return found;
}

void widen_to(Range& range, double value, double tolerance) {
  if (value < range.min - tolerance) range.min = value;
  if (value > range.max + tolerance) range.max = value;
}

class RuleFollower {
 public:
  RuleFollower(const std::vector<Body>& bodies, std::span<const Transform> pose)
      : bodies_(bodies), pose_(pose) {}

  Joint make(JointRule rule) const;

 private:
  // Of a body's skeleton joint; the world's for -1.
  Transform place(int body) const {
    return body < 0 ? Transform() : pose_[at(bodies_[at(body)].joint)];
  }
  Transform to_joint(int body) const { return body < 0 ? Transform() : bodies_[at(body)].to_joint; }
  void turn_frames(JointRule& rule, Joint& joint) const;

  const std::vector<Body>& bodies_;
  std::span<const Transform> pose_;
};

// The orientations of both frames, and ranges of angles.
void RuleFollower::turn_frames(JointRule& rule, Joint& joint) const {
  const Quat now =
      (place(rule.parent).orientation.conjugate() * place(rule.child).orientation).normalized();
  Quat in_child = Quat::Identity(), in_parent = Quat::Identity();
  if (rule.kind == JointKind::revolute) {
    const HingeAngle angle = hinge_angle(rule, now);
    if (angle_between(angle.off, Quat::Identity()) > kSameAngle) {
      rule.zero = (now * from_rotation_vector(-angle.angle * rule.axis)).normalized();
    }
    widen_to(rule.range, angle.angle, kSameAngle);
    in_child = shortest_arc(Vec3::UnitX(), rule.axis);
    in_parent = rule.zero * in_child;
  } else if (rule.kind == JointKind::prismatic) {
    in_child = shortest_arc(Vec3::UnitX(), rule.axis);
    in_parent = now * in_child;
  } else if (rule.kind == JointKind::fixed || rule.turn.kind == ik::JointLimit::Kind::locked) {
    in_parent = now;
  } else if (rule.turn.kind == ik::JointLimit::Kind::cone &&
             ik::excess(rule.turn, now) > kSameAngle) {
    include_turn(rule.turn, now);
  }
  joint.in_child.orientation =
      (to_joint(rule.child).orientation.conjugate() * in_child).normalized();
  joint.in_parent.orientation =
      (to_joint(rule.parent).orientation.conjugate() * in_parent).normalized();
}

Joint RuleFollower::make(JointRule rule) const {
  Joint joint;
  turn_frames(rule, joint);
  const Vec3 anchor = place(rule.child) * rule.anchor;
  joint.in_child.position = to_joint(rule.child).inverse() * rule.anchor;
  const Transform parent_to_world = place(rule.parent) * to_joint(rule.parent);
  joint.in_parent.position = rule.other_end ? to_joint(rule.parent).inverse() * *rule.other_end
                                            : parent_to_world.inverse() * anchor;
  if (rule.kind == JointKind::distance) {
    widen_to(rule.range, (parent_to_world * joint.in_parent.position - anchor).norm(), kSameLength);
  }
  static_cast<JointConstraint&>(joint) = rule;
  return joint;
}

}  // namespace

std::vector<JointRule> rules_of(std::span<const Joint> joints, const Skeleton& skeleton,
                                const std::vector<Body>& bodies, const ik::Limits& limits,
                                std::span<const Transform> pose) {
  std::vector<JointRule> rules;
  for (const Joint& joint : joints) {
    JointRule rule = rule_of(joint, bodies);
    if (rule.kind == JointKind::revolute && !limits.empty()) {
      // Made hinges count from the pose.
      const int own = bodies[at(rule.child)].joint;
      const int above = skeleton.parents[at(own)];
      const Quat turn = pose[at(above)].orientation.conjugate() * pose[at(own)].orientation;
      const double now = ik::measure(limits[at(own)], turn).swing[0];
      rule.zero = (rule.zero * from_rotation_vector(-now * rule.axis)).normalized();
      rule.range = {rule.range.min + now, rule.range.max + now};
    }
    round_angles(rule);
    rules.push_back(std::move(rule));
  }
  return rules;
}

std::vector<Joint> joints_of(std::span<const JointRule> rules, const std::vector<Body>& bodies,
                             std::span<const Transform> pose) {
  const RuleFollower follower(bodies, pose);
  std::vector<Joint> joints;
  for (const JointRule& rule : rules) joints.push_back(follower.make(rule));
  return joints;
}

}  // namespace krok::ragdoll
