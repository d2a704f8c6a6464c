#pragma once

#include "core/result.h"
#include "draw/plot.h"
#include "tools/common/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::plot {

// A chart of the tables in the input files. Reports what was chosen by default.
Result<draw::Chart> chart_tables(const Options& options, ToolContext& context);

}  // namespace krok::plot
