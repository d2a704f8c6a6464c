#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "render/image.h"

namespace krok::render {

// The image as a PNG file: eight bits a channel, marked as sRGB, without a time. The same image
// gives the same bytes. Code png-write where libpng cannot (no memory, an image without a pixel).
Result<std::vector<std::byte>> write_png(const Image& image);

// The pixels of a PNG file of at most `most_pixels`, transparent ones over white. Code png-read for
// what is no PNG file, is damaged, or has more.
Result<Image> read_png(std::span<const std::byte> bytes, std::size_t most_pixels = 400'000'000);

}  // namespace krok::render
