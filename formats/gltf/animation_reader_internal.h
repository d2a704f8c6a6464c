#pragma once

#include <tiny_gltf.h>

#include "core/result.h"
#include "formats/gltf/accessors_internal.h"
#include "nodes/scene.h"

// Private to this folder: animations with their channels and keys.

namespace krok::gltf {

// `scene` has its nodes and meshes already. Codes gltf-animation and those of Accessors.
Status read_animations(const tinygltf::Model& model, Accessors& accessors, nodes::Scene& scene);

}  // namespace krok::gltf
