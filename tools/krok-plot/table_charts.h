#pragma once

#include "core/result.h"
#include "draw/plot.h"
#include "tools/common/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::plot {

// A figure of the tables in the input files. What was chosen for want of options is told.
Result<draw::Chart> chart_tables(const Options& options, ToolContext& context);

}  // namespace krok::plot
