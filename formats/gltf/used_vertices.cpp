#include <algorithm>
#include <memory>
#include <utility>

#include "formats/gltf/used_vertices_internal.h"

namespace krok::gltf {

using namespace nodes;

namespace {

template <typename T>
Shared<T> picked(const Shared<T>& from, const std::vector<std::uint32_t>& used) {
  if (from == nullptr) return nullptr;
  std::vector<T> values;
  values.reserve(used.size());
  for (const std::uint32_t v : used) values.push_back((*from)[v]);
  return std::make_shared<const std::vector<T>>(std::move(values));
}

template <typename T>
std::vector<T> picked_rows(const std::vector<T>& from, std::size_t each,
                           const std::vector<std::uint32_t>& used) {
  std::vector<T> values;
  values.reserve(used.size() * each);
  for (const std::uint32_t v : used) {
    const auto row = from.begin() + static_cast<std::ptrdiff_t>(v * each);
    values.insert(values.end(), row, row + static_cast<std::ptrdiff_t>(each));
  }
  return values;
}

}  // namespace

Primitive with_used_vertices(const Primitive& whole,
                             std::vector<std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint32_t> used;
  for (const auto& triangle : triangles) used.insert(used.end(), triangle.begin(), triangle.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto each = static_cast<std::size_t>(whole.influences_per_vertex);
  Primitive part;
  part.positions = picked(whole.positions, used);
  part.normals = picked(whole.normals, used);
  part.tangents = picked(whole.tangents, used);
  part.texture_coordinates = picked(whole.texture_coordinates, used);
  for (const Shared<Vec2f>& set : whole.more_texture_coordinates) {
    part.more_texture_coordinates.push_back(picked(set, used));
  }
  part.colours = picked(whole.colours, used);
  part.influences_per_vertex = whole.influences_per_vertex;
  part.influence_joints = picked_rows(whole.influence_joints, each, used);
  part.influence_weights = picked_rows(whole.influence_weights, each, used);
  for (const MorphTarget& target : whole.targets) {
    part.targets.push_back({target.name, picked(target.positions, used),
                            picked(target.normals, used), picked(target.tangents, used)});
  }
  for (auto& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = static_cast<std::uint32_t>(std::ranges::lower_bound(used, corner) - used.begin());
    }
  }
  part.triangles = std::move(triangles);
  return part;
}

std::size_t bytes_of(const Primitive& primitive) {
  const auto influences = static_cast<std::size_t>(primitive.influences_per_vertex);
  const std::size_t each = 4 * sizeof(Vec4f) +
                           primitive.more_texture_coordinates.size() * sizeof(Vec2f) +
                           influences * (sizeof(std::uint16_t) + sizeof(float)) +
                           3 * sizeof(Vec3f) * primitive.targets.size();
  return primitive.vertex_count() * each;
}

}  // namespace krok::gltf
