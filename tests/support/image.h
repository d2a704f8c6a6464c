#pragma once

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "math/transform.h"
#include "render/image.h"

// Inspects the images that tools write.

namespace krok::test {

inline Result<render::Image> image_of(const std::string& png) {
  return render::read_png(std::as_bytes(std::span(png)));
}

// A pixel's distance from grey: backgrounds are grey, characters are not.
inline int colourfulness(render::Colour colour) {
  return std::max({colour.red, colour.green, colour.blue}) -
         std::min({colour.red, colour.green, colour.blue});
}

// The pixel at which a cell of the report shows a world point, computed from the report.
inline Vec2 place_in(const nlohmann::json& cell, double pixels_per_metre, const Vec3& point) {
  const double yaw = cell["yaw"].get<double>() * kRadiansPerDegree;
  const double elevation = cell["elevation"].get<double>() * kRadiansPerDegree;
  const auto& target = cell["target"];
  const Vec3 offset = point - Vec3(target[0], target[1], target[2]);
  const double right = std::cos(yaw) * offset.x() - std::sin(yaw) * offset.z();
  const double ahead = std::sin(yaw) * offset.x() + std::cos(yaw) * offset.z();
  const double up = std::cos(elevation) * offset.y() - std::sin(elevation) * ahead;
  const auto& middle = cell["target_pixel"];
  return Vec2(middle[0], middle[1]) + pixels_per_metre * Vec2(right, -up);
}

// The character in a cell: limits in pixels, and mean x of the left (blue) and right (orange)
// limbs.
struct Silhouette {
  int pixels = 0;
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  double blue_x = 0, orange_x = 0;  // means
};

inline Silhouette silhouette(const render::Image& image, const nlohmann::json& cell,
                             int least = 30) {
  Silhouette found;
  int blue = 0, orange = 0;
  const auto& box = cell["box"];
  for (int y = box[1]; y < box[3].get<int>(); ++y) {
    for (int x = box[0]; x < box[2].get<int>(); ++x) {
      const render::Colour colour = image.at(x, y);
      if (colourfulness(colour) < least) continue;
      ++found.pixels;
      found.left = std::min(found.left, x);
      found.right = std::max(found.right, x);
      found.top = std::min(found.top, y);
      found.bottom = std::max(found.bottom, y);
      const bool is_blue = colour.blue > colour.red;
      (is_blue ? found.blue_x : found.orange_x) += x;
      ++(is_blue ? blue : orange);
    }
  }
  if (blue > 0) found.blue_x /= blue;
  if (orange > 0) found.orange_x /= orange;
  return found;
}

}  // namespace krok::test
