#pragma once

#include <cstdint>

#include "math/types.h"

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

}  // namespace krok::render
