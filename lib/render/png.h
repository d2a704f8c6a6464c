#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "render/image.h"

namespace krok::render {

// Encodes the image as PNG: 8 bits per channel, tagged as sRGB, without a timestamp. Output is
// deterministic. Code png-write if libpng fails (out of memory, empty image).
Result<std::vector<std::byte>> write_png(const Image& image);

// Decodes a PNG file of at most `most_pixels` pixels; transparency is blended over white. Code
// png-read for data that is not a valid PNG file or has more pixels.
Result<Image> read_png(std::span<const std::byte> bytes, std::size_t most_pixels = 400'000'000);

}  // namespace krok::render
