#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ik/limits.h"
#include "ragdoll/bodies.h"
#include "ragdoll/joint.h"

// Joints between bodies as people write them (formats/ragdoll): in the frames of the skeleton's
// joints, and for any pose. Joint, in contrast, is for the solver and for one pose.

namespace krok::ragdoll {

// `turn` is of the child in the parent's skeleton joint, `slide` along the parent's axes, locked in
// what is made.
struct JointRule : JointConstraint {
  // Where the joint is, in the frame of the child's skeleton joint (of the one it moves with), and
  // for `distance` the other end, in that of the parent's. Without: where the first is in the pose.
  Vec3 anchor = Vec3::Zero();
  std::optional<Vec3> other_end;

  // Revolute and prismatic: the axis, unit, in the frame of the child's skeleton joint.
  Vec3 axis = Vec3::UnitX();
  // Revolute: the child's orientation in the parent's skeleton joint at which the angle is 0.
  Quat zero = Quat::Identity();
};

// What falls.
struct Ragdoll {
  std::vector<Body> bodies;
  std::vector<JointRule> joints;
};

// Rules that joints_of() makes such joints from in the pose that they were made for. Angles of
// hinges count from the anatomical zero of `limits` (shape [joints], or empty: from the pose).
// Angles are rounded to a millionth of a degree, so that a file holds them without loss.
std::vector<JointRule> rules_of(std::span<const Joint> joints, const Skeleton& skeleton,
                                const std::vector<Body>& bodies, const ik::Limits& limits,
                                std::span<const Transform> pose);

// The joints for a simulation that starts in `pose` (joint_to_world, shape [joints]). A hinge keeps
// the turn about its other axes that it has in the pose, ranges of angles and slides that the pose
// leaves are widened to include it, and fixed joints keep the pose.
std::vector<Joint> joints_of(std::span<const JointRule> rules, const std::vector<Body>& bodies,
                             std::span<const Transform> pose);

}  // namespace krok::ragdoll
