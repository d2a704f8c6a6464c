#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "core/result.h"
#include "nodes/scene.h"

// Reads glTF 2.0, as JSON (.gltf) or binary (.glb). Safe for untrusted input: every offset, count
// and index is checked before use, and memory is proportional to the input. Quantised data
// (KHR_mesh_quantization) and compressed data (EXT_meshopt_compression, KHR_draco_mesh_compression)
// are unpacked.
//
// Codes: gltf-container (GLB structure), gltf-json, gltf-version, gltf-extension (required but not
// supported), gltf-buffer, gltf-compression, gltf-accessor, gltf-value (not finite), gltf-node,
// gltf-mesh, gltf-skin, gltf-animation, gltf-structure (wrong types or missing properties),
// gltf-too-large.

namespace krok::gltf {

struct ReadOptions {
  // Folder of external buffers. Their paths must be relative and stay inside it. Empty: external
  // buffers are an error.
  std::string folder;
  // Opens such a buffer or image instead, by its path in that folder; for scenes in archives.
  std::function<Result<std::vector<std::byte>>(const std::string& path, std::uint64_t most_bytes)>
      open = nullptr;
  std::uint64_t most_bytes = std::uint64_t{4} << 30;  // of the input and all its buffers together
  // Also read Scene::materials, with images from buffers, data URIs and external files (same
  // rules). An unusable image is left out with a warning (gltf-picture), as are extensions of
  // materials that are not only about these (gltf-material).
  bool with_materials = false;
  // Whether Draco's data is unpacked; if not, it is an error (gltf-compression). For consumers of
  // the file itself that cannot.
  bool draco = true;
  GivenLimits limits = {};  // of Draco's decoder, which runs in a process of its own
};

Result<nodes::Scene> read(std::span<const std::byte> bytes, const ReadOptions& options = {});

// Opens and reads `path`, with its folder as ReadOptions::folder. Also the codes of InputFile.
Result<nodes::Scene> read_file(const std::string& path, ReadOptions options = {});

struct PackedGlb {
  std::vector<std::byte> bytes;
  std::vector<std::string> files;  // external files that were read
  Diagnostics diagnostics;
};

// Packs a .gltf with its buffers and images into one GLB, otherwise unchanged, for consumers that
// cannot open external files. An unreadable image becomes a grey pixel, with a warning
// (gltf-image). The input must be valid for read(). Codes: those of read(); gltf-too-large from
// 4 GiB.
Result<PackedGlb> pack_glb(std::span<const std::byte> gltf, const ReadOptions& options);

// Channels of KHR_animation_pointer for a node's own properties as glTF has them without the
// extension, for viewers that do not know it; of a GLB that read() takes, which stays as it is if
// it has none. Codes: gltf-too-large.
Result<std::vector<std::byte>> plain_channels(std::span<const std::byte> glb);

}  // namespace krok::gltf
