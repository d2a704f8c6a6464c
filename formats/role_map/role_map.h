#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// Reader for role maps, user-defined joint roles (JSON); see formats/role_map/SPEC.md.

namespace krok::role_map {

// The roles of a skeleton's joints, some of them given by the file: see find_roles with given
// roles. `path` is for messages. Errors with line and column: json-syntax, json-limit,
// role-map-shape (not the structure described in SPEC.md), role-map-joint (unknown joint; the hint
// names the nearest), role-map-role (unknown role; likewise), role-map-sides (legs and arms on
// different sides), role-twice, role-order.
Result<RoleMap> read(std::string_view text, const std::string& path, const Skeleton& skeleton);

}  // namespace krok::role_map
