#include "ragdoll/motors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/index.h"
#include "ragdoll/articulation_internal.h"

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

}  // namespace krok::ragdoll
