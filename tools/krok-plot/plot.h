#pragma once

#include "tools/common/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::plot {

// Reads motions or tables and writes one figure of them.
Result<int> run(const Options& options, ToolContext& context);

// The tool, with options of its own: each call's are independent of the others'.
ToolSpec make_spec();

}  // namespace krok::plot
