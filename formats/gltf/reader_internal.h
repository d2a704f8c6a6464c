#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/result.h"
#include "formats/gltf/accessors_internal.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"
#include "nodes/scene.h"

// Private to this folder: shared wording of the readers' messages.

namespace krok::gltf {

inline constexpr const char* kDamagedHint = "the file is damaged, or its exporter has a bug";

// "node 3 (LeftHand)", or "node 3" if there is no name.
std::string label(const char* kind, std::size_t index, const std::string& name);

// Whether an index is valid for `count` elements.
inline bool exists(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

void warn(Diagnostics& diagnostics, std::string code, std::string message, std::string hint = {});

// Call after nodes, meshes and cameras were read. Codes: gltf-animation and those of Accessors.
// Animated properties that are left out are a warning (gltf-animation-pointer).
Status read_animations(const ParsedJson& parsed, Accessors& accessors, nodes::Scene& scene);

// Fills in the scene's materials and assigns them to primitives. Never fails: what cannot be used
// is left out, with a warning in the scene's diagnostics (codes gltf-material, gltf-picture).
void read_materials(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
                    const ReadOptions& options, nodes::Scene& scene);

// Codes: gltf-mesh and those of Accessors.
Result<nodes::Mesh> read_mesh(const ParsedJson& parsed, std::size_t index, Accessors& accessors,
                              Diagnostics& diagnostics);

}  // namespace krok::gltf
