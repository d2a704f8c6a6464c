#pragma once

#include "description.h"
#include "scene/skeleton.h"
#include "tools/common/role_input.h"

namespace krok::info {

// How what the joints are is to be found out and shown.
struct SkeletonOptions {
  FindRoles roles;
  bool mapped = false;   // by a role map that the user gave
  bool verbose = false;  // list every joint
};

// Joints, end sites, which parts of a body they are, and which of a humanoid's are missing; each
// joint with its role in JSON, and with `verbose` in the text too. An Error where the map does not
// fit the skeleton.
Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out);
// The same of a skeleton whose roles are known.
void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, Description& out);

}  // namespace krok::info
