#pragma once

#include <vector>

#include "roles/joint_names.h"
#include "roles/roles.h"

namespace krok {

// The roles of joints of which it is known what their names say (shape [joints]), held against the
// structure of the skeleton. The names may come from elsewhere than the skeleton.
RoleMap roles_from_names(const Skeleton& skeleton, std::vector<JointName> names);

}  // namespace krok
