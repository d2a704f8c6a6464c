#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"
#include "nodes/scene.h"

// Reads glTF 2.0, as JSON (.gltf) or binary (.glb), from anyone: every offset, count and index is
// checked before it is used, memory stays in proportion to the input, and no input crashes it.
//
// Codes: gltf-container (the GLB's frame), gltf-json, gltf-version, gltf-extension (one that is
// required and not known), gltf-buffer, gltf-accessor, gltf-value (not finite), gltf-node,
// gltf-mesh, gltf-skin, gltf-animation, gltf-structure (wrong types or missing properties),
// gltf-too-large.

namespace krok::gltf {

struct ReadOptions {
  // Where buffers beside a .gltf are looked for. Their paths must be relative and stay inside this
  // folder. Empty: buffers in files are refused.
  std::string folder;
  std::uint64_t most_bytes = std::uint64_t{4} << 30;  // of the input and all its buffers together
  // Scene::materials too, with pictures out of buffers, data URIs and files beside the file, under
  // the same rules. A picture that cannot be used is left out with a warning (gltf-picture), as is
  // what Material does not know (gltf-material).
  bool with_materials = false;
};

Result<nodes::Scene> read(std::span<const std::byte> bytes, const ReadOptions& options = {});

// Opens `path` and reads it with its own folder as ReadOptions::folder. Also the codes of
// InputFile.
Result<nodes::Scene> read_file(const std::string& path, ReadOptions options = {});

}  // namespace krok::gltf
