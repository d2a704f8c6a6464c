#pragma once

#include <btBulletDynamicsCommon.h>

#include <vector>

#include "ragdoll/joint.h"
#include "ragdoll/world.h"

namespace krok::ragdoll {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
inline Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

// A joint as a constraint of Bullet's solver. Bullet's own joints measure limits by Euler angles or
// round cones; this one has the ranges of ik::JointLimit and all kinds from the same rows. It is
// Bullet's form of the Jacobian rows of Catto, "Iterative dynamics with temporal coherence" (2005):
// each row is J v = error, with bounds on the impulse. A hard limit is a row before it is reached,
// which lets the gap close but not further.
class BulletJoint final : public btTypedConstraint {
 public:
  BulletJoint(const Joint& joint, btRigidBody& parent, btRigidBody& child, double step);

  // Applies the impulses of soft limits and friction for one step.
  void push_back();

  double gap() const;     // metres
  double excess() const;  // radians beyond a hard limit

  Joint joint;

  void getInfo1(btConstraintInfo1* info) override;
  void getInfo2(btConstraintInfo2* info) override;
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  // J of one row on the child; the parent's linear part is the negative. World coordinates.
  struct Row {
    Vec3 linear = Vec3::Zero();
    Vec3 angular_parent = Vec3::Zero(), angular_child = Vec3::Zero();
    double error = 0;  // the speed asked for
    double low = 0, high = 0;
  };
  struct Frames {
    Vec3 arm_parent, arm_child;  // from the centres of mass to the anchors
    Quat parent, child;          // joint_to_world
    Vec3 apart;                  // from the parent's anchor to the child's
  };
  Frames frames() const;
  void find_rows();
  void add_point(const Frames& f, const Vec3& axis, double error, double low, double high);
  void add_turn(const Vec3& axis, double error, double low, double high);
  void slide_axis(const Frames& f, const Vec3& axis, double value, const Range& range);
  void distance(const Frames& f);
  void lock_turn(const Frames& f);
  void hinge(const Frames& f);
  void cone(const Frames& f);
  void motor(const Frames& f);
  void turn_limit(const Vec3& axis, double beyond);
  void spring_turn(const Vec3& axis, double beyond);
  double hinge_angle(const Frames& f) const;
  double give(const Row& row) const;  // J M^-1 J^T
  void apply(const Row& row, double impulse);

  double step_;
  std::vector<Row> rows_;
};

}  // namespace krok::ragdoll
