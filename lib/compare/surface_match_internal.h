#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/scene.h"

// Private to this folder: the nearest point of one surface to each vertex of another.

namespace krok::compare {

using Points = std::vector<Vec3>;

// Meshes of both scenes that together form one surface.
struct SurfaceGroup {
  std::vector<int> first, second;
};

// A point of a surface that moves with its triangle.
struct SurfacePoint {
  int mesh = -1;
  std::array<std::uint32_t, 3> corners{};
  std::array<double, 3> shares{};  // barycentric coordinates, summing to 1
};

// The nearest points for the vertices of one mesh.
struct SurfaceMatch {
  int mesh = -1;
  bool in_second = false;  // whether `mesh` is in the second; the points are in the other scene
  // [vertices], the nearest; without a mesh for vertices that no triangle uses.
  std::vector<SurfacePoint> points;
  // Those with the attributes that fit best, about as near: another face at a hard edge.
  std::vector<SurfacePoint> fits{};
};

// One scene at a few times: the first is used to find nearest points, the others to choose between
// surfaces that touch there.
struct SurfaceMoments {
  const std::vector<SceneMesh>& meshes;
  std::span<const SceneState> states;
  // Mean normals of the triangles' front faces at the first time, [meshes][vertices], 1 long where
  // they are flat.
  std::vector<Points> faces{};
};

inline const SceneMesh& mesh_of(const SurfacePoint& point, const SurfaceMoments& scene) {
  return scene.meshes[static_cast<std::size_t>(point.mesh)];
}

// Interpolates a value given per corner of the point's mesh: [vertices].
template <typename Vector>
Vector value_in(const SurfacePoint& point, std::span<const Vector> mesh) {
  Vector sum = Vector::Zero();
  using Number = typename Vector::Scalar;
  for (std::size_t k = 0; k < 3; ++k) {
    sum += static_cast<Number>(point.shares[k]) * mesh[point.corners[k]];
  }
  return sum;
}

// The same for all meshes, such as positions, normals or tangents: [meshes][vertices].
template <typename Vector>
Vector value_at(const SurfacePoint& point, const std::vector<std::vector<Vector>>& values) {
  return value_in(point, std::span<const Vector>(values[static_cast<std::size_t>(point.mesh)]));
}

}  // namespace krok::compare
