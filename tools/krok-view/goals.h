#pragma once

#include <string>
#include <vector>

#include "draw/viewer_page.h"
#include "tools/cli/tool.h"

namespace krok::cli::view {

// The goals of a file (formats/goals) as a motion meets them in each frame: full targets, whatever
// the goal's strength. Codes: those of open_goals(); ik-goal for a goal that cannot be, such as a
// pole without joints above and below.
Result<std::vector<draw::ViewedGoal>> viewed_goals(const std::string& path, const Clip& clip,
                                                   ToolContext& context);

}  // namespace krok::cli::view
