#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

// Decodes images with libpng and libjpeg-turbo.

namespace krok::image {

struct Pixels {
  int width = 0, height = 0;       // >= 1
  std::vector<std::uint8_t> rgba;  // [height x width x 4], row by row from the upper left
  // What is wrong with a damaged JPEG that could be decoded partially; empty if nothing.
  std::string damage;
};

// Larger than any texture for a character; four bytes per pixel.
inline constexpr std::size_t kMaxPixels = std::size_t{1} << 26;

// The pixel values of a PNG or JPEG file, 0 to 255. Colour profiles, gamma and orientation tags are
// ignored, as glTF requires (glTF 2.0 Specification, section 3.8.3). Grey is expanded to RGB,
// 16-bit channels keep their upper 8 bits, and alpha is 255 if there is none. Results are the same
// on every machine. Codes: those of image_info(); picture-size for more than `most_pixels`;
// picture-damaged if decoding fails; picture-kind for a CMYK JPEG, WebP and KTX2.
Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels = kMaxPixels);

struct GreyPixels {
  int width = 0, height = 0;  // >= 1
  std::vector<std::uint16_t>
      values;  // [height x width], row by row from the upper left, 0 to 65535
  std::vector<std::uint16_t> opacity;  // the same of the alpha channel; empty if there is none
};

// The values of a grey PNG file with all their bits; those of 8 bits and less are spread to 0 to
// 65535. Codes: those of decode(); picture-kind for JPEG and for images in colour.
Result<GreyPixels> decode_grey(std::span<const std::byte> file,
                               std::size_t most_pixels = kMaxPixels);

}  // namespace krok::image
