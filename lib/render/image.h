#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "render/colour.h"

// An image in memory and 2D drawing. Pixel (x, y) covers [x, x + 1] x [y, y + 1] with x to the
// right and y down. Drawing is clipped to the image.

namespace krok::render {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height x width x 3], sRGB

  Image() = default;
  Image(int wide, int high, Colour fill);

  Colour at(int x, int y) const;
  void set(int x, int y, Colour colour);
  // Blends `colour` over a pixel with coverage `cover` (0 .. 1).
  void blend(int x, int y, Colour colour, double cover);

 private:
  std::size_t place(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
};

// An axis-aligned rectangle; `low` is its upper left corner.
struct Box {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
};

// Anti-aliased: edges cover pixels partly.
void fill(Image& image, const Box& box, Colour colour, double opacity = 1.0);

// A straight line with round caps, `width` pixels wide, clipped to `clip`.
void draw_line(Image& image, const Vec2& from, const Vec2& to, double width, Colour colour,
               const Box& clip, double opacity = 1.0);

// Encodes the image as PNG: 8 bits per channel, tagged as sRGB, without a timestamp. Output is
// deterministic. Code png-write if libpng fails (out of memory, empty image).
Result<std::vector<std::byte>> write_png(const Image& image);

// Decodes a PNG file of at most `most_pixels` pixels; transparency is blended over white. Code
// png-read for data that is not a valid PNG file or has more pixels.
Result<Image> read_png(std::span<const std::byte> bytes, std::size_t most_pixels = 400'000'000);

}  // namespace krok::render
