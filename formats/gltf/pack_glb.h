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
  std::vector<std::string> files;  // that were read besides
  Diagnostics diagnostics;
};

// A .gltf with its buffers and images as one GLB, otherwise unchanged; for what cannot open other
// files. An image that cannot be read becomes a grey pixel, with a warning (gltf-image). The input
// must be one that read() takes. Codes: those of read(); gltf-too-large from 4 GiB on.
Result<PackedGlb> pack_glb(std::span<const std::byte> gltf, const ReadOptions& options);

}  // namespace krok::gltf
