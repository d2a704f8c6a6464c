#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/motion_charts.h"
#include "draw/plot.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "tools/cli/tool.h"
#include "tools/krok-plot/options.h"

namespace krok::cli::plot {

// The motions of the input files, which must outlive charts made from them.
struct Motions {
  struct Motion {
    std::string path;
    Clip clip;
    RoleMap roles;
  };
  std::deque<Motion> files;
  std::vector<draw::ChartedMotion> charted;  // one per entry of `files`, in the same order
  draw::ChartedGround ground;
};

// Reads the motions with their sidecars and determines which frames to show.
Result<Motions> read_motions(const std::vector<std::string>& inputs, const MotionOptions& options,
                             ToolContext& context);

// The requested charts, or by default those that fit the motions. Warns about charts that a motion
// has no data for; an Error if none is left. Adds the metrics of a difference to the report.
Result<draw::Chart> chart_motions(const Motions& motions, const Options& options,
                                  ToolContext& context);

// A chart of the tables in the input files. Reports what was chosen by default.
Result<draw::Chart> chart_tables(const Options& options, ToolContext& context);

}  // namespace krok::cli::plot
