#pragma once

#include <string>

#include "core/result.h"
#include "scene/clip.h"
#include "tools/common/tool.h"

// How far two motions are apart over time, as charts.

namespace krok::diff {

struct PlottedClip {
  std::string name;
  const Clip* clip = nullptr;
};

// Whether charts may be called `path`: Error usage where the name promises another kind of file.
Status check_plot_name(const std::string& path);

// Writes an SVG with the largest and the mean difference of joints' positions and orientations over
// time. Clips without a joint or a moment in common have none: a warning, and no file.
Status write_plot(const PlottedClip& first, const PlottedClip& second, const std::string& path,
                  ToolContext& context);

}  // namespace krok::diff
