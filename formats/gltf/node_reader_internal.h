#pragma once

#include <tiny_gltf.h>

#include "core/result.h"
#include "nodes/scene.h"

// Private to this folder: nodes, their trees, and which of them are shown.

namespace krok::gltf {

// `scene` has its cameras already. Code gltf-node.
Status read_nodes(const tinygltf::Model& model, nodes::Scene& scene);

}  // namespace krok::gltf
