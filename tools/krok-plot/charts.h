#pragma once

#include <vector>

#include "core/result.h"
#include "draw/plot.h"
#include "tools/cli/tool.h"
#include "tools/krok-plot/motions.h"
#include "tools/krok-plot/options.h"

namespace krok::cli::plot {

// The requested charts, or by default those that fit the motions. Warns about charts that a motion
// has no data for; an Error if none is left. Adds the metrics of a difference to the report.
Result<draw::Chart> chart_motions(const Motions& motions, const Options& options,
                                  ToolContext& context);

}  // namespace krok::cli::plot
