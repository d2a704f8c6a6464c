#pragma once

#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::retarget {

// Where a target joint takes its rotation from.
struct JointSource {
  int first = -1;    // a joint of the source; -1: the joint follows its parent
  int second = -1;   // a joint further along the same chain, or -1
  double share = 0;  // interpolation from first to second, 0 to 1
  double along = 0;  // for trunk joints: fraction of the way from hips (0) to chest (1)
  // Only by what of the rotation, from that of the parent's source, is about the joint's own bone.
  bool twists = false;
};

using JointMapping = std::vector<JointSource>;  // [target joints]

// The joint chain from `bottom` up the branch to its descendant `top`, both included, helpers left
// out. Only `bottom` if `top` does not descend from it.
std::vector<int> chain_between(const Skeleton& skeleton, const RoleMap& roles, int bottom, int top);

// The joint that carries the palm: the wrist, or a joint below it that is the parent of all fingers
// but the thumb (as in Acclaim skeletons). -1 if the skeleton lacks that hand.
int palm_joint(const Skeleton& skeleton, const RoleMap& roles, Role hand);

// Whether the wrist lies in the forearm (as in Acclaim skeletons): it turns the hand about the
// forearm, and the palm's joint, a good part of the forearm further, bends it.
bool wrist_twists(const Skeleton& skeleton, const RoleMap& roles, Role hand);

// The toe joints directly below the foot, skipping helpers.
std::vector<int> first_toes(const Skeleton& skeleton, const RoleMap& roles, Role foot);

// Maps joints of humanoids by their roles. Spine and neck are spread along their chains; a finger
// that the source lacks takes the joints of its neighbour, except the thumb; joints without a
// counterpart follow their parent, unless they lie between the same two joints in both skeletons,
// by the same name and reference orientation. `without_*_fingers` leaves out the fingers of that
// hand.
JointMapping map_by_roles(const Skeleton& source, const RoleMap& source_roles,
                          const Skeleton& target, const RoleMap& target_roles,
                          bool without_left_fingers, bool without_right_fingers);

// Maps joints by equal names, without end sites.
JointMapping map_by_names(const Skeleton& source, const Skeleton& target);

}  // namespace krok::retarget
