#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "ragdoll/bullet_joint_internal.h"

namespace krok::ragdoll {

namespace {

constexpr double kUnbounded = 1e18;
// The share of an error that is taken back in a step: less lets joints come apart under load, more
// makes them tremble.
constexpr double kTakeBack = 0.2;
// A limit's row is left out where it cannot be reached within a step, at 100 rad/s or m/s.
constexpr double kFastest = 100;

Quat orientation_of(const btRigidBody& body) {
  const btQuaternion q = body.getWorldTransform().getRotation();
  return Quat(q.w(), q.x(), q.y(), q.z()).normalized();
}

Vec3 turned(const btMatrix3x3& matrix, const Vec3& v) {
  return from_bullet(matrix * to_bullet(v));
}

}  // namespace

BulletJoint::BulletJoint(const Joint& its, btRigidBody& parent, btRigidBody& child, double step)
    : btTypedConstraint(D6_SPRING_2_CONSTRAINT_TYPE, parent, child), joint(its), step_(step) {}

BulletJoint::Frames BulletJoint::frames() const {
  Frames f;
  const Quat parent = orientation_of(m_rbA), child = orientation_of(m_rbB);
  f.arm_parent = parent * joint.in_parent.position;
  f.arm_child = child * joint.in_child.position;
  f.parent = parent * joint.in_parent.orientation;
  f.child = child * joint.in_child.orientation;
  f.apart = from_bullet(m_rbB.getCenterOfMassPosition() - m_rbA.getCenterOfMassPosition()) +
            f.arm_child - f.arm_parent;
  return f;
}

void BulletJoint::add_point(const Frames& f, const Vec3& axis, double error, double low,
                            double high) {
  Row row;
  row.linear = axis;
  // Both arms reach to the child's anchor, so that a sliding joint makes no torque of its own.
  row.angular_parent = -(f.arm_parent + f.apart).cross(axis);
  row.angular_child = f.arm_child.cross(axis);
  row.error = error;
  row.low = low;
  row.high = high;
  rows_.push_back(row);
}

void BulletJoint::add_turn(const Vec3& axis, double error, double low, double high) {
  Row row;
  row.angular_parent = -axis;
  row.angular_child = axis;
  row.error = error;
  row.low = low;
  row.high = high;
  rows_.push_back(row);
}

void BulletJoint::slide_axis(const Frames& f, const Vec3& axis, double value, const Range& range) {
  if (range.min == range.max) {
    add_point(f, axis, (range.min - value) * kTakeBack / step_, -kUnbounded, kUnbounded);
    return;
  }
  if (joint.soft) return;
  const double reach = kFastest * step_;
  if (value - range.min < reach) {
    const double beyond = range.min - value;
    add_point(f, axis, beyond * (beyond > 0 ? kTakeBack : 1) / step_, 0, kUnbounded);
  }
  if (range.max - value < reach) {
    const double beyond = range.max - value;
    add_point(f, axis, beyond * (beyond < 0 ? kTakeBack : 1) / step_, -kUnbounded, 0);
  }
}

void BulletJoint::distance(const Frames& f) {
  const double length = f.apart.norm();
  if (length < 1e-9) return;
  slide_axis(f, f.apart / length, length, joint.range);
}

void BulletJoint::lock_turn(const Frames& f) {
  const Vec3 off = rotation_vector(f.child * f.parent.conjugate());
  for (int axis = 0; axis < 3; ++axis) {
    add_turn(Vec3::Unit(axis), -off[axis] * kTakeBack / step_, -kUnbounded, kUnbounded);
  }
}

// A limit about `axis` (world, the way out of the range), exceeded by `beyond` radians, or not yet.
void BulletJoint::turn_limit(const Vec3& axis, double beyond) {
  if (beyond < -kFastest * step_) return;
  add_turn(axis, -beyond * (beyond > 0 ? kTakeBack : 1) / step_, -kUnbounded, 0);
}

double BulletJoint::hinge_angle(const Frames& f) const {
  const Quat turn = f.parent.conjugate() * f.child;
  const double angle = 2 * std::atan2(turn.x(), turn.w());
  const double middle = std::isfinite(joint.range.min + joint.range.max)
                            ? 0.5 * (joint.range.min + joint.range.max)
                            : 0.0;
  return angle - 2 * kPi * std::round((angle - middle) / (2 * kPi));
}

void BulletJoint::hinge(const Frames& f) {
  const Vec3 axis = f.parent * Vec3(Vec3::UnitX()), now = f.child * Vec3(Vec3::UnitX());
  const Vec3 off = axis.cross(now);
  for (const Vec3& side :
       {Vec3(f.parent * Vec3(Vec3::UnitY())), Vec3(f.parent * Vec3(Vec3::UnitZ()))}) {
    add_turn(side, -side.dot(off) * kTakeBack / step_, -kUnbounded, kUnbounded);
  }
  if (joint.soft && joint.range.min != joint.range.max) return;
  const double angle = hinge_angle(f);
  turn_limit(now, angle - joint.range.max);
  turn_limit(-now, joint.range.min - angle);
}

void BulletJoint::cone(const Frames& f) {
  const ik::JointLimit& limit = joint.turn;
  const Quat turn = f.parent.conjugate() * f.child;
  const ik::LimitAngles angles = ik::measure(limit, turn);
  const ik::LimitGradients slopes = ik::gradients(limit, turn);
  const auto apply_limit = [&](const Vec3& axis, double beyond) {
    if (joint.soft) {
      spring_turn(axis, beyond);
    } else {
      turn_limit(axis, beyond);
    }
  };
  if (limit.max_twist - limit.min_twist < 2 * kPi && slopes.twist.norm() > 1e-6) {
    const double length = slopes.twist.norm();
    const Vec3 axis = f.child * Vec3(slopes.twist / length);
    apply_limit(axis, (angles.twist - limit.max_twist) / length);
    apply_limit(-axis, (limit.min_twist - angles.twist) / length);
  }
  double ratio = 0;
  for (int i = 0; i < 2; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double swing = angles.swing[k];
    const double half = swing < 0 ? -limit.min_swing[k] : limit.max_swing[k];
    ratio = std::hypot(ratio, swing / std::max(half, 1e-6));
  }
  if (slopes.swing.norm() > 1e-6) {
    const double length = slopes.swing.norm();
    apply_limit(f.child * Vec3(slopes.swing / length), (ratio - 1) / length);
  }
}

void BulletJoint::motor(const Frames& f) {
  if (joint.motor <= 0) return;
  const Vec3 off = rotation_vector(f.parent * joint.target * f.child.conjugate());
  const Vec3 speed = f.parent * joint.target_speed;
  const double most = joint.motor * step_;
  if (joint.kind == JointKind::revolute) {
    const Vec3 axis = f.child * Vec3(Vec3::UnitX());
    add_turn(axis, axis.dot(off) * kTakeBack / step_ + axis.dot(speed), -most, most);
    return;
  }
  for (int i = 0; i < 3; ++i) {
    add_turn(Vec3::Unit(i), off[i] * kTakeBack / step_ + speed[i], -most, most);
  }
}

void BulletJoint::find_rows() {
  rows_.clear();
  const Frames f = frames();
  if (joint.kind == JointKind::distance) {
    distance(f);
    return;
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = f.parent * Vec3(Vec3::Unit(i));
    Range range{0, 0};
    if (joint.kind == JointKind::prismatic && i == 0) range = joint.range;
    if (joint.kind == JointKind::six_dof) range = joint.slide[static_cast<std::size_t>(i)];
    slide_axis(f, axis, axis.dot(f.apart), range);
  }
  if (joint.kind == JointKind::fixed || joint.kind == JointKind::prismatic ||
      (joint.kind != JointKind::revolute && joint.turn.kind == ik::JointLimit::Kind::locked)) {
    lock_turn(f);
  } else if (joint.kind == JointKind::revolute) {
    hinge(f);
  } else if (joint.turn.kind == ik::JointLimit::Kind::cone && !joint.soft) {
    cone(f);
  }
  motor(f);
}

double BulletJoint::give(const Row& row) const {
  const btMatrix3x3& a = m_rbA.getInvInertiaTensorWorld();
  const btMatrix3x3& b = m_rbB.getInvInertiaTensorWorld();
  return (m_rbA.getInvMass() + m_rbB.getInvMass()) * row.linear.squaredNorm() +
         row.angular_parent.dot(turned(a, row.angular_parent)) +
         row.angular_child.dot(turned(b, row.angular_child));
}

void BulletJoint::apply(const Row& row, double impulse) {
  m_rbA.applyCentralImpulse(to_bullet(-impulse * row.linear));
  m_rbA.applyTorqueImpulse(to_bullet(impulse * row.angular_parent));
  m_rbB.applyCentralImpulse(to_bullet(impulse * row.linear));
  m_rbB.applyTorqueImpulse(to_bullet(impulse * row.angular_child));
}

// The spring is symplectic: the new speed moves the body, so that it neither adds nor eats energy.
// Springs and dampers too strong for the step are as strong as it allows.
void BulletJoint::spring_turn(const Vec3& axis, double beyond) {
  if (beyond <= 0) return;
  Row row;
  row.angular_parent = -axis;
  row.angular_child = axis;
  const double softness = give(row);
  if (!(softness > 0)) return;
  const double speed =
      axis.dot(from_bullet(m_rbB.getAngularVelocity() - m_rbA.getAngularVelocity()));
  const double stiffness = std::min(joint.stiffness, 0.5 / (step_ * step_ * softness));
  const double damping = std::min(joint.damping, 0.5 / (step_ * softness));
  const double impulse = -step_ * (stiffness * beyond + damping * speed);
  apply(row, std::min(impulse, 0.0));
}

void BulletJoint::push_back() {
  const Frames f = frames();
  if (joint.soft && joint.kind == JointKind::revolute) {
    const Vec3 axis = f.child * Vec3(Vec3::UnitX());
    const double angle = hinge_angle(f);
    spring_turn(axis, angle - joint.range.max);
    spring_turn(-axis, joint.range.min - angle);
  } else if (joint.soft && joint.turn.kind == ik::JointLimit::Kind::cone &&
             (joint.kind == JointKind::spherical || joint.kind == JointKind::six_dof)) {
    cone(f);
  }
  if (joint.soft) {
    rows_.clear();
    const auto spring = [&](const Vec3& axis, double value, const Range& range) {
      if (range.min == range.max) return;
      for (const double side : {1.0, -1.0}) {
        const double beyond = side > 0 ? value - range.max : range.min - value;
        if (!(beyond > 0)) continue;
        add_point(f, side * axis, 0, 0, 0);
        const Row row = rows_.back();
        const double softness = give(row);
        const Vec3 speed =
            from_bullet(m_rbB.getVelocityInLocalPoint(to_bullet(f.arm_child)) -
                        m_rbA.getVelocityInLocalPoint(to_bullet(f.arm_parent + f.apart)));
        const double stiffness = std::min(joint.stiffness, 0.5 / (step_ * step_ * softness));
        const double impulse = -step_ *
                               (stiffness * beyond + joint.damping * row.linear.dot(speed)) /
                               (1 + step_ * joint.damping * softness);
        apply(row, std::min(impulse, 0.0));
      }
    };
    if (joint.kind == JointKind::distance && f.apart.norm() > 1e-9) {
      spring(f.apart.normalized(), f.apart.norm(), joint.range);
    } else if (joint.kind == JointKind::prismatic) {
      const Vec3 axis = f.parent * Vec3(Vec3::UnitX());
      spring(axis, axis.dot(f.apart), joint.range);
    } else if (joint.kind == JointKind::six_dof) {
      for (int i = 0; i < 3; ++i) {
        const Vec3 axis = f.parent * Vec3(Vec3::Unit(i));
        spring(axis, axis.dot(f.apart), joint.slide[static_cast<std::size_t>(i)]);
      }
    }
  }
  if (joint.friction <= 0) return;
  for (int i = 0; i < 3; ++i) {
    Row row;
    row.angular_parent = -Vec3::Unit(i);
    row.angular_child = Vec3::Unit(i);
    const double speed =
        row.angular_child.dot(from_bullet(m_rbB.getAngularVelocity() - m_rbA.getAngularVelocity()));
    apply(row, -step_ * std::min(joint.friction, 0.5 / (step_ * give(row))) * speed);
  }
}

double BulletJoint::gap() const {
  const Frames f = frames();
  if (joint.kind == JointKind::distance) {
    if (joint.soft) return 0;
    const double length = f.apart.norm();
    return std::max({0.0, length - joint.range.max, joint.range.min - length});
  }
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    Range range{0, 0};
    if (joint.kind == JointKind::prismatic && i == 0) range = joint.range;
    if (joint.kind == JointKind::six_dof) range = joint.slide[static_cast<std::size_t>(i)];
    if (joint.soft && range.min != range.max) continue;
    const double value = (f.parent * Vec3(Vec3::Unit(i))).dot(f.apart);
    const double beyond = std::max({0.0, value - range.max, range.min - value});
    square += beyond * beyond;
  }
  return std::sqrt(square);
}

double BulletJoint::excess() const {
  if (joint.soft) return 0;
  const Frames f = frames();
  if (joint.kind == JointKind::revolute) {
    const double angle = hinge_angle(f);
    return std::max({0.0, angle - joint.range.max, joint.range.min - angle});
  }
  if (joint.kind != JointKind::spherical && joint.kind != JointKind::six_dof) return 0;
  return ik::excess(joint.turn, (f.parent.conjugate() * f.child).normalized());
}

void BulletJoint::getInfo1(btConstraintInfo1* info) {
  find_rows();
  info->m_numConstraintRows = static_cast<int>(rows_.size());
  info->nub = 0;
}

void BulletJoint::getInfo2(btConstraintInfo2* info) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const std::size_t at = i * static_cast<std::size_t>(info->rowskip);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      info->m_J1linearAxis[at + k] = static_cast<btScalar>(-row.linear[axis]);
      info->m_J2linearAxis[at + k] = static_cast<btScalar>(row.linear[axis]);
      info->m_J1angularAxis[at + k] = static_cast<btScalar>(row.angular_parent[axis]);
      info->m_J2angularAxis[at + k] = static_cast<btScalar>(row.angular_child[axis]);
    }
    info->m_constraintError[at] = static_cast<btScalar>(row.error);
    info->cfm[at] = 0;
    info->m_lowerLimit[at] = static_cast<btScalar>(row.low);
    info->m_upperLimit[at] = static_cast<btScalar>(row.high);
  }
}

}  // namespace krok::ragdoll
