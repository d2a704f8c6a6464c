#pragma once

#include <span>
#include <vector>

#include "ik/limits.h"
#include "ragdoll/bodies.h"
#include "ragdoll/joint.h"
#include "roles/roles.h"

namespace krok::ragdoll {

struct BodyJointOptions {
  // For humanoids; of other skeletons scaled by their extent (torques in proportion to it).
  // Soft limits push back with these, for a joint that carries one kilogram; heavier ones have more
  // in proportion. Beyond their range knees of adults resist with some N m for each degree (Riener
  // and Edrich 1999), which are 4 for a shank and foot of 4.3 kg.
  bool soft = false;
  double stiffness = 50;  // N m/rad
  double damping = 2;     // N m s/rad
  // Resistance of muscles and tissue at rest, N m s/rad for each kilogram that the joint carries.
  double friction = 0.2;
  double dry_friction = 0.1;  // N m for each kilogram: lying limbs come to rest
};

// The joints between bodies, one for each body with a parent, at the joint of the skeleton that the
// body moves with. Knees and elbows are hinges, spine and neck six_dof without sliding, all others
// spherical. Ranges are those of `limits` (shape [joints], as for ik; empty: none); where joints
// between have no body, theirs are added to the next one's. `pose` (joint_to_world, shape [joints])
// is where the simulation starts: what has no body keeps its place there, and ranges that it leaves
// are widened to include it.
std::vector<Joint> make_joints(const Skeleton& skeleton, const RoleMap& roles,
                               const std::vector<Body>& bodies, const ik::Limits& limits,
                               std::span<const Transform> pose, const BodyJointOptions& options);

// Widens a cone so that it includes a rotation.
void include_turn(ik::JointLimit& limit, const Quat& turn);

}  // namespace krok::ragdoll
