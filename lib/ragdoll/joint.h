#pragma once

#include <array>
#include <limits>
#include <string_view>

#include "ik/limits.h"
#include "math/transform.h"

// A joint between two bodies, or between a body and the world.

namespace krok::ragdoll {

enum class JointKind : unsigned char {
  fixed,      // neither moves nor turns
  distance,   // the anchors stay within a distance of one another
  spherical,  // turns about the anchor, within `turn`
  revolute,   // turns about x of its frame
  prismatic,  // slides along x of its frame
  six_dof     // turns within `turn`, slides within `slide` along each axis
};

std::string_view joint_kind_name(JointKind kind);  // "spherical"

// Ranges are radians, or metres for what slides. A range from -infinity to infinity does not limit;
// one whose ends are equal locks.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

// What a joint ties, and how far and how easily that moves.
struct JointConstraint {
  JointKind kind = JointKind::spherical;
  int parent = -1;  // body, or -1 for the world
  int child = 0;    // body

  Range range;                 // revolute, prismatic, distance (min >= 0)
  ik::JointLimit turn;         // spherical, six_dof: free, locked or a cone
  std::array<Range, 3> slide;  // six_dof

  // Hard limits stop. Soft ones push back beyond them, with a torque of stiffness (N m/rad) times
  // the excess and damping (N m s/rad) times the speed away from the range; where something slides,
  // a force (N/m, N s/m).
  bool soft = false;
  double stiffness = 100, damping = 0;  // >= 0

  double friction = 0;  // N m s/rad, >= 0: slows all turning within the joint
};

struct Joint : JointConstraint {
  // The joint's frame in the frames of both bodies (their centres of mass). Angles and distances
  // are 0 where the two coincide; `turn` is of the child's frame in the parent's.
  Transform in_parent, in_child;

  double dry_friction = 0;  // N m, >= 0: as `friction`, the same at any speed

  // A motor turns the child towards `target` (in the parent's frame) and its speed to
  // `target_speed` (radians/s, in the parent's frame), as a spring (N m/rad) and a damper (N m
  // s/rad) would, with about this torque at most (N m); 0: none. Spherical, revolute and six_dof.
  double motor = 0, motor_stiffness = 0, motor_damping = 0;  // >= 0
  Quat target = Quat::Identity();
  Vec3 target_speed = Vec3::Zero();
};

// Whether the anchors may come apart: prismatic, distance, and six_dof with a range to slide in.
bool can_slide(const Joint& joint);

}  // namespace krok::ragdoll
