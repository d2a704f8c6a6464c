#pragma once

#include <cstdint>

#include "math/types.h"

namespace krok::render {

// A colour as screens take it (sRGB, eight bits a channel).
struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;

  bool operator==(const Colour&) const = default;
};

// 0x3d7fd9, as colours are written in pages.
constexpr Colour colour(std::uint32_t rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16 & 0xFF), static_cast<std::uint8_t>(rgb >> 8 & 0xFF),
          static_cast<std::uint8_t>(rgb & 0xFF)};
}

// The colour that lies at `share` on the way from a (0) to b (1); beyond them, the nearer one.
constexpr Colour mixed(Colour a, Colour b, double share) {
  const double part = share > 0 ? (share < 1 ? share : 1.0) : 0.0;
  const auto channel = [part](int from, int to) {
    // Never negative. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::uint8_t>(from + (to - from) * part + 0.5);
  };
  return {channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue)};
}

// The light that a screen gives off for it, and the colour for a light: linear, 0 to 1 for each of
// red, green and blue; beyond that, the nearer end. Source: IEC 61966-2-1 (sRGB).
Vec3f to_light(Colour colour);
Colour to_colour(const Vec3f& light);

}  // namespace krok::render
