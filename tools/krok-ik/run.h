#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-ik/options.h"

namespace krok::cli::ik {

// Reads the motion, its goals and limits; writes the motion with the goals brought about. Goals
// that are missed are warnings (ik-missed). Codes: those of the readers, of formats/goals,
// formats/limits and lib/ik; ik-joint for a joint of an option that the motion has not.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::ik
