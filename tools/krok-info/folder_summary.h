#pragma once

#include <string>

#include "tools/cli/report.h"

namespace krok::cli::info {

// Many files at a glance: a row for each (kind, frames, rate, duration, joints, body), then how
// many of what kind, how long they are together, at which rates and of how many skeletons. `files`
// as in the report; those that could not be read have no kind.
std::string folder_summary(const Json& files);

}  // namespace krok::cli::info
