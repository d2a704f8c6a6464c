#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "nodes/scene.h"
#include "tools/common/tool.h"

namespace krok {

// The node of the camera that --camera names: by the node's name, the camera's, or a number from 0
// in `cameras`, which are nodes with cameras and not empty. For an empty `wanted` it is the first,
// with a warning that lists them where there are several (code import-cameras). An Error (code
// import-camera) for a name that none has. `path` is the scene's file.
Result<int> choose_camera(const nodes::Scene& scene, std::span<const int> cameras,
                          const std::string& wanted, const std::string& path, ToolContext& context);

}  // namespace krok
