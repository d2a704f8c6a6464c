#pragma once

#include <string>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"
#include "tools/cli/tool.h"

namespace krok::cli::retarget {

// The pose that --takes gives a motion: a T-pose built from it and from all takes of the same
// joints in files, folders and patterns. Others are left out with a warning. Empty if the
// skeleton's reference pose stands, which then is the pose.
Result<std::vector<Transform>> pose_of_takes(const std::vector<std::string>& takes,
                                             const Clip& source, const RoleMap& roles,
                                             ToolContext& context);

}  // namespace krok::cli::retarget
