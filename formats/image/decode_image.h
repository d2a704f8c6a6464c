#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

// The pixels of pictures, by libpng and libjpeg-turbo.

namespace krok::image {

struct Pixels {
  int width = 0, height = 0;       // >= 1
  std::vector<std::uint8_t> rgba;  // [height x width x 4], from the upper left row by row
  // What the decoder put up with, where a JPEG is damaged and the rest of it shows; may be empty.
  std::string damage;
};

// What nobody paints for a figure; four bytes of memory each.
inline constexpr std::size_t kMaxPixels = std::size_t{1} << 26;

// A PNG or JPEG file as numbers from 0 to 255, as the file has them: profiles, gamma and turns that
// the file asks for do not count, as glTF says (glTF 2.0 Specification, section 3.8.3). Grey
// becomes three equal channels, of 16 bits the upper ones are kept, and alpha is 255 where there is
// none. The same file gives the same pixels on every machine. Codes: those of picture_facts();
// picture-size with more than `most_pixels`; picture-damaged for what does not decode; picture-kind
// for a JPEG in printing inks.
Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels = kMaxPixels);

}  // namespace krok::image
