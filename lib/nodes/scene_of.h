#pragma once

#include <memory>

#include "core/result.h"
#include "nodes/scene.h"
#include "scene/scene.h"

namespace krok::nodes {

// The displayed scene of a file: a mesh for each instance, the joints of Evaluator::joints(), all
// animations. In the file's unit and axes. Codes: those of Evaluator::create(), gltf-too-large.
Result<krok::Scene> scene_of(std::shared_ptr<const Scene> from_file);

}  // namespace krok::nodes
