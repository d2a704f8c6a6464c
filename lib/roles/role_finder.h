#pragma once

#include <vector>

#include "roles/joint_names.h"
#include "roles/roles.h"

namespace krok {

// Roles from part and side of each joint (shape [joints]), checked against the hierarchy. `names`
// may come from another source than the skeleton's joint names.
RoleMap roles_from_names(const Skeleton& skeleton, std::vector<JointName> names);

}  // namespace krok
