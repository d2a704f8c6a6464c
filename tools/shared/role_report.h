#pragma once

#include <optional>
#include <string>
#include <vector>

#include "roles/body_frame.h"
#include "roles/roles.h"
#include "scene/skeleton.h"
#include "tools/cli/report.h"

// Joint roles of a skeleton, as text and as JSON.

namespace krok::cli {

struct RoleRow {
  std::string label;
  std::string text;
};

// Whether the skeleton is a humanoid, the joints of each body part, missing roles, joints without a
// role, and roles given by the user. Long lists of joints are truncated; joint names are unchanged.
std::vector<RoleRow> role_rows(const Skeleton& skeleton, const RoleMap& map);

// "humanoid"; "roles", each with its joint, or a list of joints for roles that several may have;
// "missing_roles", those required for a humanoid; "unknown_joints", those without a role, except
// end sites; "given_roles", from the user: one role per joint, null where a role was removed.
Json roles_json(const Skeleton& skeleton, const RoleMap& map);

// {"metres": 1.71, "uncertainty": 0.04}, or null.
Json stature_json(const std::optional<Stature>& stature);

}  // namespace krok::cli
