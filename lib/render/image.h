#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"

namespace krok::render {

// An 8-bit sRGB colour.
struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;

  bool operator==(const Colour&) const = default;
};

// From 0xRRGGBB, such as 0x3d7fd9.
constexpr Colour colour(std::uint32_t rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16 & 0xFF), static_cast<std::uint8_t>(rgb >> 8 & 0xFF),
          static_cast<std::uint8_t>(rgb & 0xFF)};
}

// Interpolates linearly from a (0) to b (1); `share` is clamped.
constexpr Colour mixed(Colour a, Colour b, double share) {
  const double part = share > 0 ? (share < 1 ? share : 1.0) : 0.0;
  const auto channel = [part](int from, int to) {
    // Never negative. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::uint8_t>(from + (to - from) * part + 0.5);
  };
  return {channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue)};
}

// sRGB to linear light and back, 0 to 1 per channel; values out of range are clamped. Source: IEC
// 61966-2-1 (sRGB).
Vec3f to_light(Colour colour);
Colour to_colour(const Vec3f& light);

// An image in memory and 2D drawing. Pixel (x, y) covers [x, x + 1] x [y, y + 1] with x to the
// right and y down. Drawing is clipped to the image.

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
