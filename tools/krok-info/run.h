#pragma once

#include "tools/krok-info/options.h"

namespace krok::cli::info {

// Describes each file on standard output and in the report. Continues after a file that cannot be
// read; the exit code is then kExitTrouble.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::info
