#pragma once

#include <string>

#include "compare/scene_difference.h"
#include "core/result.h"
#include "scene/model.h"
#include "tools/common/tool.h"

// Where meshes differ, as colours of the first one's vertices.

namespace krok::diff {

// Whether --heatmap may have this name: Error usage.
Status check_heatmap_name(const std::string& path);

// Writes the first scene's meshes, as they stand where the difference is largest, with each vertex
// in the colour of its largest distance over all moments (`found` must have kept them), and says
// what the colours stand for. Scenes without a mesh that was compared have none: a warning, and no
// file.
Status write_heatmap(const compare::Scene& first, const compare::SceneDifference& found,
                     const std::string& path, ToolContext& context);

// The same of two models in their reference poses.
Status write_heatmap(const Model& first, const Model& second, const compare::SceneOptions& options,
                     const std::string& path, ToolContext& context);

}  // namespace krok::diff
