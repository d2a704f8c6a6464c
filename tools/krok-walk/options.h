#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "math/transform.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::walk {

struct Options {
  std::vector<std::string> libraries;
  std::string map;
  // One of path, prints and goals.
  std::string path, path_id;
  double path_scale = 0;  // metres per unit of an SVG
  std::string prints;
  std::vector<Vec2> goals;          // x, z, metres
  std::array<double, 3> from = {};  // x, z, metres, and the heading there, radians
  GroundChoice ground;
  std::string save_prints;
  std::string view;                               // a page to write, or empty
  std::optional<double> step_length, step_width;  // metres
  std::vector<double> pace;                       // m/s, over the way
  FootSide first = FootSide::left;
  double speed = 1, rate = 0;  // 0: the library's
  bool adapt = false, extrapolate = false, strict = false;
  double stretch = 0, clearance = 0;  // metres
  double variation = 0.85;
  std::uint64_t seed = 1;
  std::string style;  // or part of captures' names
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::walk
