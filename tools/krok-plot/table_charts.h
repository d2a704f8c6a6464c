#pragma once

#include "core/result.h"
#include "draw/plot.h"
#include "tools/cli/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::cli::plot {

// A chart of the tables in the input files. Reports what was chosen by default.
Result<draw::Chart> chart_tables(const Options& options, ToolContext& context);

}  // namespace krok::cli::plot
