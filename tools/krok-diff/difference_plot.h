#pragma once

#include <string>

#include "compare/clip_difference.h"
#include "compare/scene_difference.h"
#include "core/result.h"
#include "scene/clip.h"
#include "tools/common/tool.h"

// How far two motions or scenes are apart over time, as charts: the largest difference and the root
// of the mean square, the tolerance, and where the difference is largest.

namespace krok::diff {

struct PlottedClip {
  std::string name;
  const Clip* clip = nullptr;
};

// Whether charts may be called `path`: Error usage where the name promises another kind of file.
Status check_plot_name(const std::string& path);

// Writes an SVG of joints' positions and orientations. Clips without a joint or a moment in common
// have none: a warning, and no file.
Status write_plot(const PlottedClip& first, const PlottedClip& second,
                  const compare::ClipDifference& found, const std::string& path,
                  ToolContext& context);

// Writes an SVG of what two scenes have of positions, normals and tangents of vertices and of
// positions and orientations of joints, at the moments that were compared; of several animations
// those that differ, eight at most. Scenes that do not move have none: a warning, and no file.
struct PlottedScenes {
  std::string first_name, second_name;
  const compare::Scene* first = nullptr;
  const compare::SceneDifference* found = nullptr;
};
Status write_plot(const PlottedScenes& scenes, const std::string& path, ToolContext& context);

}  // namespace krok::diff
