#include "scene/tangents.h"

#include <algorithm>
#include <cmath>

namespace krok {

namespace {

// The component of `direction` in the plane of a unit normal, normalised; zero if it vanishes.
Vec3 in_plane(const Vec3& direction, const Vec3& normal) {
  const Vec3 part = direction - normal.dot(direction) * normal;
  const double length = part.norm();
  return length > 1e-12 * direction.norm() && std::isfinite(length) ? Vec3(part / length)
                                                                    : Vec3(Vec3::Zero());
}

double angle_between(const Vec3& a, const Vec3& b) {
  const double lengths = a.norm() * b.norm();
  return lengths > 0 ? std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) : 0.0;
}

}  // namespace

std::vector<Vec4f> make_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                                 std::span<const Vec2f> coordinates,
                                 std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Vec3> sums(positions.size(), Vec3::Zero());
  std::vector<double> sides(positions.size(), 0.0);
  for (const auto& triangle : triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = positions[triangle[k]].cast<double>();
    const auto coordinate = [&](std::size_t k) -> Vec2 {
      return coordinates[triangle[k]].cast<double>();
    };
    const Vec2 first = coordinate(1) - coordinate(0), second = coordinate(2) - coordinate(0);
    const double area = first.x() * second.y() - first.y() * second.x();
    if (area == 0 || !std::isfinite(area)) continue;
    const double side = area > 0 ? 1 : -1;
    const Vec3 along_u =
        side * ((corners[1] - corners[0]) * second.y() - (corners[2] - corners[0]) * first.y());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = triangle[k];
      const Vec3 normal = normals[vertex].cast<double>();
      const double weight =
          angle_between(corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
      sums[vertex] += weight * in_plane(along_u, normal);
      // Seen from outside, in an image that is not mirrored v, which points down, is clockwise of
      // u.
      sides[vertex] -= weight * side;
    }
  }
  std::vector<Vec4f> tangents;
  tangents.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 normal = normals[v].cast<double>();
    Vec3 tangent = in_plane(sums[v], normal);
    if (tangent.isZero(0)) tangent = normal.unitOrthogonal();
    const Vec3f rounded = tangent.cast<float>();
    tangents.emplace_back(rounded.x(), rounded.y(), rounded.z(), sides[v] < 0 ? -1.0f : 1.0f);
  }
  return tangents;
}

bool needs_tangents(const Model& model, std::span<const Material> materials) {
  if (model.normals.empty() || model.texture_coordinates.empty()) return false;
  return std::ranges::any_of(model.parts, [&](const Model::Part& part) {
    const Material* const material = find_material(materials, part.material);
    return material != nullptr && material->normal_texture;
  });
}

}  // namespace krok
