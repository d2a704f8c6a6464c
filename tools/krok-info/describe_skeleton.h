#pragma once

#include "formats/io/open_role_map.h"
#include "scene/skeleton.h"
#include "tools/krok-info/description.h"

namespace krok::cli::info {

// How joint roles are found and printed.
struct SkeletonOptions {
  io::FindRoles roles;
  bool mapped = false;   // by a role map that the user gave
  bool verbose = false;  // list every joint
};

// Joints, end sites, body parts, missing humanoid roles and stature. Lists each joint with its role
// in JSON, and with `verbose` also in the text. An Error if the map does not match the skeleton.
Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out);
// The same for known roles; `metres` is the skeleton's unit.
void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, double metres,
                  Description& out);

}  // namespace krok::cli::info
