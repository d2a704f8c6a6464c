#pragma once

#include "tools/common/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::plot {

// Reads motions or tables and writes one chart of them.
Result<int> run(const Options& options, ToolContext& context);

// A new tool with its own options, independent of those of other calls.
ToolSpec make_spec();

}  // namespace krok::plot
