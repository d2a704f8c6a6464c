#pragma once

#include <vector>

#include "core/result.h"
#include "draw/plot.h"
#include "tools/common/tool.h"
#include "tools/krok-plot/motions.h"
#include "tools/krok-plot/options.h"

namespace krok::plot {

// The charts that the options ask for, or that fit the motions where they ask for none. What a
// motion has not is told, and an Error where nothing is left. Puts figures of a difference into the
// report.
Result<draw::Chart> chart_motions(const Motions& motions, const Options& options,
                                  ToolContext& context);

}  // namespace krok::plot
