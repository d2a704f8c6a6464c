#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

// What a user says that joints are, in a text file; formats/role_map/SPEC.md describes it.

namespace krok::role_map {

// The roles of a skeleton's joints with what the file says of some of them: see find_roles with
// given roles. `path` is for messages. Errors with line and column: json-syntax, json-limit,
// role-map-shape (not an object of the form that SPEC.md tells), role-map-joint (no joint has that
// name; the hint tells the nearest), role-map-role (no such role; likewise), role-twice,
// role-order.
Result<RoleMap> read(std::string_view text, const std::string& path, const Skeleton& skeleton);

}  // namespace krok::role_map
