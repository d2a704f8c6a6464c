#pragma once

#include "tools/krok-retarget/options.h"

namespace krok::cli::retarget {

// Reads the motion and the target, and writes the motion on the target's skeleton. Codes: those of
// the readers, of formats/role_map and of lib/retarget.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::retarget
