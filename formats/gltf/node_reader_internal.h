#pragma once

#include "core/result.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"

// Private to this folder: reads the node hierarchy and visibility.

namespace krok::gltf {

// Call after cameras were read. Code: gltf-node; a camera that does not exist is a warning.
Status read_nodes(const ParsedJson& parsed, nodes::Scene& scene);

}  // namespace krok::gltf
