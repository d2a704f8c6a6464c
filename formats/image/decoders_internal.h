#pragma once

#include <cstddef>
#include <span>

#include "core/result.h"
#include "formats/image/decode_image.h"

// Private to this folder. Both libraries leave with longjmp where they fail, so that what they call
// stands in functions without anything to destroy.

namespace krok::image {

// Fills the pixels in, whose size is that of the file. Code picture-damaged.
Status decode_png(std::span<const std::byte> file, Pixels& pixels);

// The same; code picture-kind too.
Status decode_jpeg(std::span<const std::byte> file, Pixels& pixels);

}  // namespace krok::image
