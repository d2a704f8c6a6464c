#pragma once

#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::retarget {

// Where a target joint takes its rotation from.
struct JointSource {
  int first = -1;    // a joint of the source; -1: the joint follows its parent
  int second = -1;   // one further along the same chain, or -1
  double share = 0;  // how far from first to second, 0 to 1
  double along = 0;  // for joints of the trunk: how far from the hips (0) to the chest (1)
};

using JointMapping = std::vector<JointSource>;  // [target joints]

// The joints that lie between two joints of a skeleton and turn with a body of their own: from
// `bottom` (included) up the tree's branch to `top` (included), helpers left out. Only `bottom`
// where `top` does not descend from it.
std::vector<int> chain_between(const Skeleton& skeleton, const RoleMap& roles, int bottom, int top);

// The joint whose rotation the palm has: the wrist's, or one in the palm that all fingers but the
// thumb hang on (Acclaim's hand below its wrist). -1 for a figure without that hand.
int palm_joint(const Skeleton& skeleton, const RoleMap& roles, Role hand);

// The toes that hang on the foot itself.
std::vector<int> first_toes(const Skeleton& skeleton, const RoleMap& roles, Role foot);

// Joints of humanoids by their roles. Spine and neck are spread along their chains; a finger that
// the source has not takes its neighbour's joints, the thumb apart; what the source has nothing for
// follows its parent. `without_fingers` leaves out the fingers of a hand (left, right).
JointMapping map_by_roles(const Skeleton& source, const RoleMap& source_roles,
                          const Skeleton& target, const RoleMap& target_roles,
                          bool without_left_fingers, bool without_right_fingers);

// Joints by equal names, end sites left out.
JointMapping map_by_names(const Skeleton& source, const Skeleton& target);

}  // namespace krok::retarget
