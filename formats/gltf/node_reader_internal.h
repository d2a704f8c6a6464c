#pragma once

#include <tiny_gltf.h>

#include "core/result.h"
#include "nodes/scene.h"

// Private to this folder: reads the node hierarchy and visibility.

namespace krok::gltf {

// Call after cameras were read. Code: gltf-node.
Status read_nodes(const tinygltf::Model& model, nodes::Scene& scene);

}  // namespace krok::gltf
