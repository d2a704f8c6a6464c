#pragma once

#include "core/result.h"
#include "formats/gltf/accessors_internal.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"

// Private to this folder: reads animations, channels and keys.

namespace krok::gltf {

// Call after nodes, meshes and cameras were read. Codes: gltf-animation and those of Accessors.
// Animated properties that are left out are a warning (gltf-animation-pointer).
Status read_animations(const ParsedJson& parsed, Accessors& accessors, nodes::Scene& scene);

}  // namespace krok::gltf
