#include "render/colour.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace krok::render {

Vec3f to_light(Colour colour) {
  static const auto table = [] {
    std::array<float, 256> result;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double value = static_cast<double>(i) / 255.0;
      result[i] = static_cast<float>(value <= 0.04045 ? value / 12.92
                                                      : std::pow((value + 0.055) / 1.055, 2.4));
    }
    return result;
  }();
  return {table[colour.red], table[colour.green], table[colour.blue]};
}

Colour to_colour(const Vec3f& light) {
  const auto channel = [](float value) {
    const double kept = std::clamp(static_cast<double>(value), 0.0, 1.0);
    const double screen =
        kept <= 0.0031308 ? 12.92 * kept : 1.055 * std::pow(kept, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(screen * 255.0));
  };
  return {channel(light.x()), channel(light.y()), channel(light.z())};
}

}  // namespace krok::render
