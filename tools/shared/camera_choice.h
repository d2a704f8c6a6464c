#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "nodes/scene.h"
#include "tools/cli/tool.h"

namespace krok::cli {

// The node of the camera selected by --camera: by node name, camera name, or index into `cameras`,
// the nodes with cameras, not empty. If `wanted` is empty, the first, with a warning that lists all
// if there are several (code import-cameras). Fails (code import-camera) if there is no match.
// `path` is the scene's file.
Result<int> choose_camera(const nodes::Scene& scene, std::span<const int> cameras,
                          const std::string& wanted, const std::string& path, ToolContext& context);

}  // namespace krok::cli
