#include "skin/surface_normals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

namespace krok {

namespace {

std::tuple<float, float, float> key_of(const Vec3f& value) {
  return {value.x(), value.y(), value.z()};
}

}  // namespace

std::vector<std::uint32_t> shading_groups(std::span<const Vec3f> positions,
                                          std::span<const Vec3f> normals) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    return std::pair(key_of(positions[v]),
                     normals.empty() ? std::tuple(0.f, 0.f, 0.f) : key_of(normals[v]));
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    const auto left = key(a), right = key(b);
    return left != right ? left < right : a < b;
  });
  std::vector<std::uint32_t> groups(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    groups[order[i]] = same ? groups[order[i - 1]] : order[i];
  }
  return groups;
}

void normals_of(std::span<const std::array<std::uint32_t, 3>> triangles,
                std::span<const Vec3f> positions, std::span<const std::uint32_t> groups,
                std::span<Vec3f> normals) {
  assert(groups.size() == positions.size() && normals.size() == positions.size());
  std::vector<Vec3> sums(positions.size(), Vec3::Zero());
  for (const auto& triangle : triangles) {
    const auto corner = [&](std::size_t k) -> Vec3 {
      return positions[triangle[k]].cast<double>();
    };
    const Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const std::uint32_t vertex : triangle) sums[groups[vertex]] += area;
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vec3& sum = sums[groups[v]];
    const double length = sum.stableNorm();
    const bool regular = length > 0 && std::isfinite(length);
    normals[v] = regular ? Vec3f((sum / length).cast<float>()) : Vec3f(Vec3f::UnitY());
  }
}

void moved_normals(std::span<const std::array<std::uint32_t, 3>> triangles,
                   std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                   std::span<const Vec3f> moved_positions, std::span<Vec3f> moved) {
  const std::vector<std::uint32_t> groups = shading_groups(positions, normals);
  std::vector<Vec3f> before(positions.size());
  normals_of(triangles, positions, groups, before);
  normals_of(triangles, moved_positions, groups, moved);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Vec3 sum =
        normals[v].cast<double>() + (moved[v].cast<double>() - before[v].cast<double>());
    const double length = sum.norm();
    // Keeps the normal if the surface flips, where the sum is zero.
    if (moved[v] == before[v] || !(length > 1e-6)) {
      moved[v] = normals[v];
    } else {
      moved[v] = (sum / length).cast<float>();
    }
  }
}

}  // namespace krok
