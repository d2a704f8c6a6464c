#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/gltf_reader.h"

namespace krok::gltf {

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

}  // namespace krok::gltf
