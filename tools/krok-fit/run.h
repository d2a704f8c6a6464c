#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-fit/options.h"

namespace krok::cli::fit {

// Reads, fits, writes, reports.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::fit
