#pragma once

#include <functional>
#include <string>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/skeleton.h"
#include "tools/common/tool.h"

// --map: what joints are, where their names do not tell.

namespace krok {

CommandOption add_map_option(
    CommandOptions& command, std::string& path, const std::string& name = "--map",
    const std::string& description =
        "What joints are, where their names do not tell: a role map (JSON)");

using FindRoles = std::function<Result<RoleMap>(const Skeleton& skeleton)>;

// Opens the role map that a path names, as an input of the run. What is returned gives a skeleton's
// roles as the map has them, and may be used on several skeletons and threads; for an empty path it
// is find_roles. Its errors are those of role_map::read.
Result<FindRoles> open_role_map(const std::string& path, ToolContext& context);

}  // namespace krok
