#pragma once

#include <string>

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-fit/options.h"

// Correctives: the same tool for sculpted poses of a model.

namespace krok::cli::fit {

// Whether the file at `path` describes sculpted poses; false where it cannot be opened.
bool describes_poses(const std::string& path);

// Reads poses and shapes, fits correctives, writes and reports them. Codes: those of
// corrective_poses::read(), of reading motions and shapes, and of fit_correctives(), with the
// location in the description; fit-pose (a frame that the motion does not have, another skeleton, a
// shape of no mesh).
Result<int> run_correctives(const Options& options, ToolContext& context);

}  // namespace krok::cli::fit
