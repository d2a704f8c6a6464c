#include "ragdoll/body_joints.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/bodies.h"

namespace krok::ragdoll {

namespace {

constexpr double kAdultExtent = 1.7;  // metres, which the options are for

bool is_hinge(Role role) {
  return role == Role::left_lower_leg || role == Role::right_lower_leg ||
         role == Role::left_lower_arm || role == Role::right_lower_arm;
}

bool is_trunk(Role role) {
  return role == Role::spine || role == Role::chest || role == Role::neck || role == Role::head;
}

// How far a swing is out, as a share of the ellipse.
double swing_ratio(const ik::JointLimit& limit, const std::array<double, 2>& swing) {
  double sum = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double half = swing[i] < 0 ? -limit.min_swing[i] : limit.max_swing[i];
    sum += swing[i] == 0 ? 0 : std::pow(swing[i] / std::max(half, 1e-6), 2);
  }
  return std::sqrt(sum);
}

// Scales the swing's ellipse by `factor`, and the twist.
void widen(ik::JointLimit& limit, double swing, double twist) {
  for (std::size_t i = 0; i < 2; ++i) {
    limit.min_swing[i] = std::max(-kPi, limit.min_swing[i] * swing);
    limit.max_swing[i] = std::min(kPi, limit.max_swing[i] * swing);
  }
  limit.min_twist = std::max(-kPi, limit.min_twist * twist);
  limit.max_twist = std::min(kPi, limit.max_twist * twist);
}

class JointMaker {
 public:
  JointMaker(const Skeleton& skeleton, const RoleMap& roles, const std::vector<Body>& bodies,
             const ik::Limits& limits, std::span<const Transform> pose)
      : skeleton_(skeleton), roles_(roles), bodies_(bodies), limits_(limits), pose_(pose) {}

  Joint make(int child) const;

 private:
  double between(int child) const;
  void spherical(Joint& joint, const Body& body, const Body& above, double share) const;
  void hinge(Joint& joint, const Body& body, const Body& above) const;
  Vec3 bend_axis(int joint) const;

  const Skeleton& skeleton_;
  const RoleMap& roles_;
  const std::vector<Body>& bodies_;
  const ik::Limits& limits_;
  std::span<const Transform> pose_;
};

// The joints that this one turns for: itself, and those up to the body above that are of the trunk.
double JointMaker::between(int child) const {
  const int end = bodies_[at(bodies_[at(child)].parent)].joint;
  double count = 1;
  for (int j = skeleton_.parents[at(bodies_[at(child)].joint)]; j >= 0 && j != end;
       j = skeleton_.parents[at(j)]) {
    if (is_trunk(roles_.roles[at(j)])) ++count;
  }
  return count;
}

void JointMaker::spherical(Joint& joint, const Body& body, const Body& above, double share) const {
  if (limits_.empty()) return;
  joint.turn = limits_[at(body.joint)];
  if (joint.turn.kind != ik::JointLimit::Kind::cone) {
    joint.turn = {};
    return;
  }
  // The range is of joint_to_parent; joints between keep the turn they have.
  const Quat parent = pose_[at(skeleton_.parents[at(body.joint)])].orientation;
  const Quat kept = pose_[at(above.joint)].orientation.conjugate() * parent;
  joint.turn.zero = (kept * joint.turn.zero).normalized();
  if (share > 1) widen(joint.turn, share, share);
  include_turn(joint.turn,
               pose_[at(above.joint)].orientation.conjugate() * pose_[at(body.joint)].orientation);
}

// In the joint's frame: the axis about which the limb is bent if it is bent enough, otherwise the
// anatomical one.
Vec3 JointMaker::bend_axis(int joint) const {
  const Vec3 anatomical = limits_[at(joint)].swing_axis;
  const Body* lower = nullptr;
  const Body* upper = nullptr;
  for (const Body& body : bodies_) {
    if (body.joint == joint) lower = &body;
  }
  if (lower == nullptr || lower->parent < 0) return anatomical;
  upper = &bodies_[at(lower->parent)];
  const Vec3 knee = pose_[at(joint)].position;
  const Vec3 before = knee - pose_[at(upper->joint)] * upper->to_joint.position;
  const Vec3 after = pose_[at(joint)] * lower->to_joint.position - knee;
  const Vec3 normal = before.cross(after);
  if (normal.norm() < std::sin(20 * kRadiansPerDegree) * before.norm() * after.norm()) {
    return anatomical;
  }
  const Vec3 axis = pose_[at(joint)].orientation.conjugate() * normal.normalized();
  if (std::abs(axis.dot(anatomical)) < 0.7) return anatomical;
  return axis.dot(anatomical) < 0 ? Vec3(-axis) : axis;
}

// Angles count from the pose, which the hinge keeps about its other axes.
void JointMaker::hinge(Joint& joint, const Body& body, const Body& above) const {
  const ik::JointLimit& limit = limits_[at(body.joint)];
  const Vec3 axis = bend_axis(body.joint);
  const Quat x_to_axis = shortest_arc(Vec3::UnitX(), axis);
  const Quat turn =
      pose_[at(above.joint)].orientation.conjugate() * pose_[at(body.joint)].orientation;
  const Quat own = pose_[at(skeleton_.parents[at(body.joint)])].orientation.conjugate() *
                   pose_[at(body.joint)].orientation;
  const double now = ik::measure(limit, own).swing[0];
  joint.kind = JointKind::revolute;
  joint.range = {std::min(0.0, limit.min_swing[0] - now), std::max(0.0, limit.max_swing[0] - now)};
  joint.in_child.orientation = (joint.in_child.orientation * x_to_axis).normalized();
  joint.in_parent.orientation =
      (above.to_joint.orientation.conjugate() * turn * x_to_axis).normalized();
}

Joint JointMaker::make(int child) const {
  const Body& body = bodies_[at(child)];
  const Body& above = bodies_[at(body.parent)];
  const Transform above_to_world = pose_[at(above.joint)] * above.to_joint;
  Joint joint;
  joint.child = child;
  joint.parent = body.parent;
  // Both frames have the axes of the skeleton's joints.
  joint.in_child = body.to_joint.inverse();
  joint.in_parent = {above_to_world.inverse() * pose_[at(body.joint)].position,
                     above.to_joint.orientation.conjugate()};
  const Role role = roles_.roles[at(body.joint)];
  const bool cone = !limits_.empty() && limits_[at(body.joint)].kind == ik::JointLimit::Kind::cone;
  if (is_hinge(role) && cone) {
    hinge(joint, body, above);
    return joint;
  }
  spherical(joint, body, above, is_trunk(role) ? between(child) : 1.0);
  if (is_trunk(role)) {
    joint.kind = JointKind::six_dof;
    joint.slide.fill({0, 0});
  }
  return joint;
}

}  // namespace

void include_turn(ik::JointLimit& limit, const Quat& turn) {
  const ik::LimitAngles angles = ik::measure(limit, turn);
  limit.min_twist = std::min(limit.min_twist, angles.twist);
  limit.max_twist = std::max(limit.max_twist, angles.twist);
  const double ratio = swing_ratio(limit, angles.swing);
  if (ratio > 1) widen(limit, ratio, 1);
}

std::vector<Joint> make_joints(const Skeleton& skeleton, const RoleMap& roles,
                               const std::vector<Body>& bodies, const ik::Limits& limits,
                               std::span<const Transform> pose, const BodyJointOptions& options) {
  std::vector<double> carried(bodies.size());
  for (std::size_t b = bodies.size(); b-- > 0;) {
    carried[b] += bodies[b].mass;
    if (bodies[b].parent >= 0) carried[at(bodies[b].parent)] += carried[b];
  }
  // What weights do to joints grows with the lengths of their levers, how long they take with the
  // roots of these.
  const double size = roles.humanoid ? 1 : extent(skeleton) / kAdultExtent;
  const JointMaker maker(skeleton, roles, bodies, limits, pose);
  std::vector<Joint> joints;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].parent < 0) continue;
    Joint joint = maker.make(static_cast<int>(b));
    joint.soft = options.soft;
    joint.stiffness = options.stiffness * carried[b] * size;
    joint.damping = options.damping * carried[b] * std::pow(size, 1.5);
    joint.friction = options.friction * carried[b] * std::pow(size, 1.5);
    joint.dry_friction = options.dry_friction * carried[b] * size;
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace krok::ragdoll
