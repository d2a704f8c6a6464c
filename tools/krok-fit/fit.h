#pragma once

#include "tools/common/tool.h"
#include "tools/krok-fit/options.h"

namespace krok::fit_tool {

// Reads, fits, writes, reports.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::fit_tool
