#pragma once

#include <cstddef>

#include "core/result.h"
#include "formats/gltf/accessors_internal.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"

// Private to this folder: reads meshes with primitives, influences and morph targets.

namespace krok::gltf {

// Codes: gltf-mesh and those of Accessors.
Result<nodes::Mesh> read_mesh(const ParsedJson& parsed, std::size_t index, Accessors& accessors,
                              Diagnostics& diagnostics);

}  // namespace krok::gltf
