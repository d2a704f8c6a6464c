#pragma once

#include <cstddef>
#include <span>

#include "core/result.h"
#include "formats/image/decode_image.h"

// Private to this folder. Both libraries report errors with longjmp, so functions that it may skip
// must not have objects with destructors.

namespace krok::image {

// Fills in the pixels, whose size is already set from the file. Code: picture-damaged.
Status decode_png(std::span<const std::byte> file, Pixels& pixels);

// Fills in `values`, [height x width x 2]: grey and alpha, which is 65535 without such a channel,
// and whether there is one. Codes: picture-damaged, picture-kind.
struct GreyAndAlpha {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;
  bool has_alpha = false;
};
Status decode_grey_png(std::span<const std::byte> file, GreyAndAlpha& pixels);

// As decode_png. Codes: picture-damaged, picture-kind.
Status decode_jpeg(std::span<const std::byte> file, Pixels& pixels);

}  // namespace krok::image
