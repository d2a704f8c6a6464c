#pragma once

#include <string>

#include "compare/scene_difference.h"
#include "core/result.h"
#include "scene/model.h"
#include "tools/cli/tool.h"

// Mesh differences as vertex colours of the first mesh.

namespace krok::cli::diff {

// Error usage if the extension of --heatmap is not supported.
Status check_heatmap_name(const std::string& path);

// Writes the first scene's meshes, in the pose of the max difference, with each vertex coloured by
// its max distance over all times (`found` must have kept them), and prints the legend. If no mesh
// was compared: a warning, and no file.
Status write_heatmap(const Scene& first, const compare::SceneDifference& found,
                     const std::string& path, ToolContext& context);

// The same for two scenes that were not compared as such.
Status write_heatmap(const Scene& first, const Scene& second, const compare::SceneOptions& options,
                     const std::string& path, ToolContext& context);

}  // namespace krok::cli::diff
