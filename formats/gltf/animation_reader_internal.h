#pragma once

#include <tiny_gltf.h>

#include "core/result.h"
#include "formats/gltf/accessors_internal.h"
#include "nodes/scene.h"

// Private to this folder: reads animations, channels and keys.

namespace krok::gltf {

// Call after nodes and meshes were read. Codes: gltf-animation and those of Accessors.
Status read_animations(const tinygltf::Model& model, Accessors& accessors, nodes::Scene& scene);

}  // namespace krok::gltf
