#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::cli::plot {

// Reads motions or tables and writes one chart of them.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::plot
