#pragma once

#include <string>

#include "compare/clip_difference.h"
#include "compare/scene_difference.h"
#include "core/result.h"
#include "scene/clip.h"
#include "tools/cli/tool.h"

// Charts of the differences of two motions or scenes over time: max and RMS, the tolerance, and the
// time of the max.

namespace krok::cli::diff {

struct PlottedClip {
  std::string name;
  const Clip* clip = nullptr;
};

// Error usage if the extension of `path` is not .svg.
Status check_plot_name(const std::string& path);

struct Plot {
  std::string svg;
  std::size_t left_out = 0;  // animations that differ but are not drawn
};

// The differences of joint positions and orientations. Code diff-plot if the clips have no joint or
// time in common.
Result<Plot> plot_of(const PlottedClip& first, const PlottedClip& second,
                     const compare::ClipDifference& found);

struct PlottedScenes {
  std::string first_name, second_name;
  const Scene* first = nullptr;
  const compare::SceneDifference* found = nullptr;
};
// The differences of vertex positions, normals and tangents and of joint positions and
// orientations, at the times compared; for several animations, of those that differ, at most eight.
// Code diff-plot if the scenes are static.
Result<Plot> plot_of(const PlottedScenes& scenes);

// Writes the SVG. If there is nothing to draw (diff-plot): a warning, and no file.
Status write_plot(const Result<Plot>& plot, const std::string& path, ToolContext& context);

}  // namespace krok::cli::diff
