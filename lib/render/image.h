#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

}  // namespace krok::render
