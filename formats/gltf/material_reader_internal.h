#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"

// Private to this folder: reads materials.

namespace krok::gltf {

// Fills in the scene's materials and assigns them to primitives. Never fails: what cannot be used
// is left out, with a warning in the scene's diagnostics (codes gltf-material, gltf-picture).
void read_materials(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
                    const ReadOptions& options, nodes::Scene& scene);

}  // namespace krok::gltf
