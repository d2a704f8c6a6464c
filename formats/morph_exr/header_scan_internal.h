#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/result.h"

// Private to the readers of OpenEXR files: checks an OpenEXR header before the library reads it,
// which allocates memory by the sizes in the header.

namespace krok::morph_exr {

struct HeaderFacts {
  std::uint32_t width = 0, height = 0;
};

// Checks that the file is a single-part scan-line image with lossless compression (NO, RLE, ZIPS or
// ZIP), that its attributes are within the file, and that the image size is possible for the file
// size, at `bytes_per_texel` at least. Code: exr-header, with the byte offset.
Result<HeaderFacts> scan_header(std::span<const std::byte> file, int bytes_per_texel = 12);

}  // namespace krok::morph_exr
