#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/motion_charts.h"
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

}  // namespace krok::cli::plot
