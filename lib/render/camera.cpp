#include "render/camera.h"

#include <cmath>

namespace krok::render {

Vec3 Camera::right() const {
  return {std::cos(yaw), 0, -std::sin(yaw)};
}

Vec3 Camera::up() const {
  return {-std::sin(yaw) * std::sin(elevation), std::cos(elevation),
          -std::cos(yaw) * std::sin(elevation)};
}

Vec3 Camera::towards() const {
  return {std::sin(yaw) * std::cos(elevation), std::sin(elevation),
          std::cos(yaw) * std::cos(elevation)};
}

Vec2 Camera::project(const Vec3& point) const {
  const Vec3 offset = point - target;
  return place_of_target + pixels_per_metre * Vec2(right().dot(offset), -up().dot(offset));
}

}  // namespace krok::render
