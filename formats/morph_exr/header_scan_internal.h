#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/result.h"

// Private to this folder: a look at an OpenEXR header before the library gets it, which trusts the
// sizes that stand there with memory.

namespace krok::morph_exr {

struct HeaderFacts {
  std::uint32_t width = 0, height = 0;
};

// Whether the file is a single-part picture of scan lines, without loss (NO, RLE, ZIPS or ZIP
// compression), whose attributes lie within it, and whose size is one that so many bytes can hold.
// Code exr-header, with the byte.
Result<HeaderFacts> scan_header(std::span<const std::byte> file);

}  // namespace krok::morph_exr
