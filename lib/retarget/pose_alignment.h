#pragma once

#include <span>
#include <vector>

#include "retarget/joint_mapping.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// Brings a target's reference pose to that of a source, whatever stance either is in: T-pose,
// A-pose, arms forward.
//
// For each target joint a rotation of the world that, applied to its reference orientation, makes
// its bone point as the source's does in the source's reference pose. Hips and chest are turned by
// their left-right and up directions; how far the trunk leans in a stance is taken for the build of
// the body, not for a bend, unless it is much. Limbs are turned bone by bone, each by the smallest
// angle beyond its parent's turn, so that no twist comes in. A hand is turned by the direction of
// its fingers and of its knuckles (or thumbs, where one side has no more). Feet are turned about
// the vertical alone, for soles are flat in a stance whatever the height of the ankle.

namespace krok::retarget {

// A pose and what its joints are.
struct Actor {
  const Skeleton& skeleton;
  const RoleMap& roles;
  std::span<const Transform> pose;  // joint_to_world, shape [joints]
};

// Shape [target joints]; joints that are not mapped get their parent's turn.
std::vector<Quat> align_by_roles(const Actor& source, const Actor& target,
                                 const JointMapping& mapping);

// For figures mapped by names: each joint is turned so that the bones to its mapped children point
// as the source's; by its parent's turn where it has none.
std::vector<Quat> align_by_names(const Actor& source, const Actor& target,
                                 const JointMapping& mapping);

// The place that shows where a foot points: its first joint of the toes, or the end of the foot.
// -1 where there is neither.
int foot_front(const Skeleton& skeleton, const RoleMap& roles, Role foot);

}  // namespace krok::retarget
