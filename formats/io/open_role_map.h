#pragma once

#include <functional>
#include <string>

#include "formats/io/inputs.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::io {

using FindRoles = std::function<Result<RoleMap>(const Skeleton& skeleton)>;

// Opens a role map (formats/role_map). The result maps a skeleton's joints to roles as the file
// says and may be used on several skeletons and threads; for an empty path it is find_roles(). Its
// errors are those of role_map::read().
Result<FindRoles> open_role_map(const std::string& path, Inputs& inputs);

}  // namespace krok::io
