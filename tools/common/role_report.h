#pragma once

#include <string>
#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"
#include "tools/common/report.h"

// What the joints of a skeleton are, for people and for programs.

namespace krok {

struct RoleRow {
  std::string label;
  std::string text;
};

// Whether it is a humanoid, the joints of its parts, what it lacks, which joints have no role, and
// what the user gave. Long lists of joints are cut; names stand as the skeleton has them.
std::vector<RoleRow> role_rows(const Skeleton& skeleton, const RoleMap& map);

// "humanoid"; "roles", each with its joint, or with the list of its joints where many may have it;
// "missing_roles", of those that a humanoid must have; "unknown_joints", those without a role, end
// sites apart; "given_roles", what the user gave: a role a joint, null where one was taken away.
Json roles_json(const Skeleton& skeleton, const RoleMap& map);

}  // namespace krok
