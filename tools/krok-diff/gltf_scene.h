#pragma once

#include <memory>
#include <string>

#include "compare/scene_difference.h"
#include "core/result.h"
#include "nodes/scene.h"

namespace krok::cli::diff {

// A glTF asset as a scene of lib/compare. The scene refers to `asset`, which must outlive it.
Result<compare::Scene> scene_of(const nodes::Scene& asset);

// "1 mesh, 10,120 vertices, 20,236 triangles; 31 joints; 1 animation".
std::string summary_of(const compare::Scene& scene);

}  // namespace krok::cli::diff
