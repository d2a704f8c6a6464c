#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compare/scene.h"
#include "core/result.h"

// Private to this folder: which point of one surface is nearest to each vertex of another.

namespace krok::compare {

using Points = std::vector<Vec3>;

// Meshes of both scenes that together are one surface.
struct SurfaceGroup {
  std::vector<int> first, second;
};

// A point of a surface that moves with its triangle.
struct SurfacePoint {
  int mesh = -1;
  std::array<std::uint32_t, 3> corners{};
  std::array<double, 3> shares{};  // of the corners, together 1
};

// The points that belong to the vertices of one mesh.
struct SurfaceMatch {
  int mesh = -1;
  bool in_second = false;            // whose mesh it is; the points are the other scene's
  std::vector<SurfacePoint> points;  // [vertices]
};

// One scene at a few moments: the one at which nearest points are found, and others by which
// surfaces that touch there are told apart.
struct SurfaceMoments {
  const std::vector<SceneMesh>& meshes;
  std::span<const SceneState> states;
};

// The value of a point where each corner has one, as positions, normals and tangents
// ([meshes][vertices]).
template <typename Vector>
Vector value_at(const SurfacePoint& point, const std::vector<std::vector<Vector>>& values) {
  const std::vector<Vector>& mesh = values[static_cast<std::size_t>(point.mesh)];
  Vector sum = Vector::Zero();
  for (std::size_t k = 0; k < 3; ++k) sum += point.shares[k] * mesh[point.corners[k]];
  return sum;
}

}  // namespace krok::compare
