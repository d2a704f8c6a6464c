// If these fail, shapes without normals are lit wrongly: with seams where the texture is cut, other
// than a sphere is, or changed where the surface has not moved.

#include "skin/surface_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/transform.h"

namespace krok {
namespace {

struct ShadedMesh {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// A sphere of rings and columns, cut along one meridian: there vertices stand twice.
ShadedMesh sphere(int rings, int columns) {
  ShadedMesh mesh;
  for (int r = 0; r <= rings; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const double up = kPi * r / rings, around = 2 * kPi * (c % columns) / columns;
      const double radius = r % rings == 0 ? 0 : std::sin(up);  // one place at each pole
      mesh.positions.push_back(
          Vec3(radius * std::sin(around), std::cos(up), radius * std::cos(around)).cast<float>());
    }
  }
  const auto at = [&](int r, int c) { return static_cast<std::uint32_t>(r * (columns + 1) + c); };
  for (int r = 0; r < rings; ++r) {
    for (int c = 0; c < columns; ++c) {
      mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
      mesh.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
    }
  }
  return mesh;
}

std::vector<Vec3f> normals(const ShadedMesh& mesh) {
  std::vector<Vec3f> result(mesh.positions.size());
  normals_of(mesh.triangles, mesh.positions, shading_groups(mesh.positions, {}), result);
  return result;
}

TEST(SurfaceNormals, ASphereShadesRoundSeamAndAll) {
  const ShadedMesh mesh = sphere(40, 60);
  const std::vector<Vec3f> found = normals(mesh);
  for (std::size_t v = 0; v < found.size(); ++v) {
    EXPECT_GT(found[v].dot(mesh.positions[v]), 0.9995f) << v;
    EXPECT_NEAR(found[v].norm(), 1, 1e-6);
  }
}

TEST(SurfaceNormals, VerticesWithOtherNormalsStayApart) {
  const std::vector<Vec3f> positions = {Vec3f::Zero(), Vec3f::Zero(), Vec3f::UnitX(),
                                        Vec3f::Zero()};
  const std::vector<Vec3f> edge = {Vec3f::UnitX(), Vec3f::UnitY(), Vec3f::UnitX(), Vec3f::UnitX()};
  EXPECT_EQ(shading_groups(positions, edge), (std::vector<std::uint32_t>{0, 1, 2, 0}));
  EXPECT_EQ(shading_groups(positions, {}), (std::vector<std::uint32_t>{0, 0, 2, 0}));
}

TEST(SurfaceNormals, WithoutAnAreaTheyPointUp) {
  const ShadedMesh flat = {{Vec3f::Zero(), Vec3f::UnitX(), Vec3f(2, 0, 0), Vec3f(0, 0, 3)},
                           {{0, 1, 2}}};
  for (const Vec3f& normal : normals(flat)) EXPECT_EQ(normal, Vec3f::UnitY());
}

TEST(SurfaceNormals, OnlyWhatMovesChanges) {
  const ShadedMesh mesh = sphere(20, 30);
  // An artist's own normals, which no triangle gives.
  std::vector<Vec3f> own(mesh.positions.size());
  for (std::size_t v = 0; v < own.size(); ++v) {
    own[v] = (mesh.positions[v] + Vec3f(0.2f, 0, 0)).normalized();
  }
  std::vector<Vec3f> moved = mesh.positions, result(own.size());
  for (Vec3f& position : moved) {
    if (position.y() > 0.5f) position.y() = 0.5f + 3 * (position.y() - 0.5f);
  }
  moved_normals(mesh.triangles, mesh.positions, own, moved, result);
  int changed = 0;
  for (std::size_t v = 0; v < own.size(); ++v) {
    EXPECT_NEAR(result[v].norm(), 1, 1e-5);
    if (mesh.positions[v].y() < 0.3f) {
      EXPECT_EQ(result[v], own[v]) << v;
    } else if ((result[v] - own[v]).norm() > 0.05f) {
      ++changed;
    }
  }
  EXPECT_GT(changed, 50);
}

}  // namespace
}  // namespace krok
