#include "scene/mesh_volume.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace krok {

std::vector<std::uint32_t> first_at_position(std::span<const Vec3> positions) {
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = positions[a], &q = positions[b];
    const bool odd_p = p.hasNaN(), odd_q = q.hasNaN();
    if (odd_p || odd_q) return odd_p != odd_q ? odd_q : a < b;
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), before);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

namespace {

using Triangle = std::array<std::uint32_t, 3>;

bool is_closed(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const auto place = first_at_position(positions);
  // Each edge, lower index first, with 1 or -1 for its direction.
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, int>> edges;
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place[triangle[k]], b = place[triangle[(k + 1) % 3]];
      if (a < b) edges.push_back({{a, b}, 1});
      if (b < a) edges.push_back({{b, a}, -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    int sum = 0;
    std::size_t next = i;
    for (; next < edges.size() && edges[next].first == edges[i].first; ++next) {
      sum += edges[next].second;
    }
    if (sum != 0) return false;
    i = next;
  }
  return !triangles.empty();
}

}  // namespace

MeshVolume mesh_volume(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t vertex : triangle) box.extend(positions[vertex]);
  }
  const Vec3 middle = box.isEmpty() ? Vec3(Vec3::Zero()) : box.center();
  MeshVolume result;
  for (const Triangle& triangle : triangles) {
    const Vec3 a = positions[triangle[0]] - middle;
    const Vec3 b = positions[triangle[1]] - middle;
    const Vec3 c = positions[triangle[2]] - middle;
    result.volume += a.dot(b.cross(c)) / 6;
    result.area += (b - a).cross(c - a).norm() / 2;
  }
  result.closed = is_closed(positions, triangles);
  return result;
}

}  // namespace krok
