#pragma once

#include <string>
#include <vector>

#include "ik/solver.h"

// Robot arms by their Denavit and Hartenberg parameters, as trees of hinges.

namespace krok::bench {

struct Link {
  double a, alpha, d;      // metres, radians: Rot_z(angle) Trans_z(d) Trans_x(a) Rot_x(alpha)
  double lowest, highest;  // of the joint's angle, degrees
};

struct Arm {
  std::string name;
  std::vector<Link> links;
};

// Corke and Armstrong-Helouvry, "A search for consensus among model parameters reported for the
// PUMA 560 robot", 1994; ranges by its maker.
inline Arm puma_560() {
  return {"Puma 560",
          {{0, kPi / 2, 0, -160, 160},
           {0.4318, 0, 0, -45, 225},
           {0.0203, -kPi / 2, 0.15005, -225, 45},
           {0, kPi / 2, 0.4318, -110, 170},
           {0, -kPi / 2, 0, -100, 100},
           {0, 0, 0, -266, 266}}};
}

// KUKA LBR iiwa 14 R820, data sheet.
inline Arm lbr_iiwa_14() {
  return {"LBR iiwa 14",
          {{0, -kPi / 2, 0.36, -170, 170},
           {0, kPi / 2, 0, -120, 120},
           {0, kPi / 2, 0.42, -170, 170},
           {0, -kPi / 2, 0, -120, 120},
           {0, -kPi / 2, 0.4, -170, 170},
           {0, kPi / 2, 0, -120, 120},
           {0, 0, 0.126, -175, 175}}};
}

inline Transform after_turn(const Link& link) {
  return {Vec3(link.a, 0, link.d), Quat(Eigen::AngleAxisd(link.alpha, Vec3::UnitX()))};
}

// The last link's end for given joint angles, by the parameters alone.
inline Transform end_of(const Arm& arm, const std::vector<double>& angles) {
  Transform end;
  for (std::size_t i = 0; i < arm.links.size(); ++i) {
    end = end * Transform{Vec3::Zero(), Quat(Eigen::AngleAxisd(angles[i], Vec3::UnitZ()))} *
          after_turn(arm.links[i]);
  }
  return end;
}

// The arm as joints: joint i turns about its own z; in the pose every angle is the middle of its
// range.
struct ArmJoints {
  std::vector<int> parents;
  ik::Limits limits;
  std::vector<Transform> middle;  // joint_to_world
  Transform tip;                  // the end in the last joint's frame
};

inline ArmJoints joints_of(const Arm& arm) {
  ArmJoints joints;
  Transform world, before;
  for (std::size_t i = 0; i < arm.links.size(); ++i) {
    const Link& link = arm.links[i];
    ik::JointLimit limit;
    limit.kind = ik::JointLimit::Kind::hinge;
    limit.zero = before.orientation;
    limit.axis = Vec3::UnitZ();
    limit.min_twist = link.lowest * kRadiansPerDegree;
    limit.max_twist = link.highest * kRadiansPerDegree;
    const double middle = 0.5 * (limit.min_twist + limit.max_twist);
    world =
        world * before * Transform{Vec3::Zero(), Quat(Eigen::AngleAxisd(middle, Vec3::UnitZ()))};
    before = after_turn(link);
    joints.parents.push_back(static_cast<int>(i) - 1);
    joints.limits.push_back(limit);
    joints.middle.push_back(world);
  }
  joints.tip = before;
  return joints;
}

}  // namespace krok::bench
