// Would fail if the volume or the area of a body came out otherwise than its closed form, depended
// on where the body is, or was given for a surface with a hole.

#include "scene/mesh_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace krok {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  MeshVolume measured() const { return mesh_volume(positions, triangles); }
};

// Edges of length 2 about `middle`, each face with four vertices of its own, as files have them.
Mesh cube(const Vec3& middle = Vec3::Zero()) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        Vec3 corner;
        corner[axis] = side;
        corner[(axis + 1) % 3] = side * u;
        corner[(axis + 2) % 3] = v;
        mesh.positions.push_back(middle + corner);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

// A tube along +X of length 1 with flat ends, `rings` polygons whose radius and turn are given.
template <class Ring>
Mesh tube(std::uint32_t rings, std::uint32_t sides, const Ring& ring) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    const double place = static_cast<double>(i) / (rings - 1);
    for (std::uint32_t k = 0; k < sides; ++k) {
      const auto [y, z] = ring(place, 2 * kPi * k / sides);
      mesh.positions.emplace_back(place, y, z);
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return i * sides + k % sides; };
  for (std::uint32_t k = 0; k < sides; ++k) {
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      mesh.triangles.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
    }
    if (k > 0 && k + 1 < sides) {
      mesh.triangles.push_back({at(0, 0), at(0, k + 1), at(0, k)});
      mesh.triangles.push_back({at(rings - 1, 0), at(rings - 1, k), at(rings - 1, k + 1)});
    }
  }
  return mesh;
}

TEST(MeshVolume, OfACube) {
  const MeshVolume measured = cube().measured();
  EXPECT_TRUE(measured.closed);
  EXPECT_DOUBLE_EQ(measured.volume, 8);
  EXPECT_DOUBLE_EQ(measured.area, 24);
}

// From the origin the terms would be 1e12 times the sum.
TEST(MeshVolume, DoesNotDependOnThePlace) {
  const MeshVolume measured = cube(Vec3(4e6, -4e6, 4e6)).measured();
  EXPECT_TRUE(measured.closed);
  EXPECT_NEAR(measured.volume, 8, 1e-9);
}

TEST(MeshVolume, InsideOutIsNegative) {
  Mesh mesh = cube();
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  const MeshVolume measured = mesh.measured();
  EXPECT_TRUE(measured.closed);
  EXPECT_DOUBLE_EQ(measured.volume, -8);
  EXPECT_DOUBLE_EQ(measured.area, 24);
}

// A sphere as a tube of rings whose ends have shrunk to points.
TEST(MeshVolume, OfASphere) {
  Mesh mesh = tube(401, 400, [](double place, double angle) {
    const double radius = std::sqrt(std::max(0.0, 0.25 - (place - 0.5) * (place - 0.5)));
    return std::pair(radius * std::cos(angle), radius * std::sin(angle));
  });
  const MeshVolume measured = mesh.measured();
  EXPECT_TRUE(measured.closed);
  EXPECT_NEAR(measured.volume, kPi / 6, 1e-4);
  EXPECT_NEAR(measured.area, kPi, 2e-3);
}

// What linear blend makes of a cylinder whose ends are turned against each other: the mean of two
// points of a circle an angle apart, at each place with its weights.
TEST(MeshVolume, OfACylinderTwistedByLinearBlend) {
  constexpr double kRadius = 0.1;
  for (const double twist : {0.0, 0.5, kPi / 2, 2.5, kPi}) {
    const Mesh mesh = tube(301, 200, [&](double place, double angle) {
      const double y = (1 - place) * std::cos(angle) + place * std::cos(angle + twist);
      const double z = (1 - place) * std::sin(angle) + place * std::sin(angle + twist);
      return std::pair(kRadius * y, kRadius * z);
    });
    const MeshVolume measured = mesh.measured();
    EXPECT_TRUE(measured.closed);
    // In the middle the radius is cos(twist / 2) of the whole; over the length the squares of the
    // radii, 1 - 2 w (1 - w) (1 - cos twist), have this mean.
    const double whole = kPi * kRadius * kRadius;
    EXPECT_NEAR(measured.volume / whole, 1 - (1 - std::cos(twist)) / 3, 3e-4) << twist;
  }
}

TEST(MeshVolume, AHoleIsSeen) {
  Mesh mesh = cube();
  mesh.triangles.pop_back();
  EXPECT_FALSE(mesh.measured().closed);
  // Two faces that share an edge but run the same way along it.
  mesh = cube();
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_FALSE(mesh.measured().closed);
}

TEST(MeshVolume, OfNothing) {
  const MeshVolume none = mesh_volume({}, {});
  EXPECT_FALSE(none.closed);
  EXPECT_EQ(none.volume, 0);
  EXPECT_EQ(none.area, 0);
  // A triangle without extent has no edge; -0 is where 0 is.
  const std::vector<Vec3> point = {Vec3(0, 0, 0), Vec3(-0.0, 0, 0), Vec3(0, 0, 0)};
  const std::vector<Triangle> flat = {{0, 1, 2}};
  EXPECT_TRUE(mesh_volume(point, flat).closed);
  EXPECT_EQ(mesh_volume(point, flat).volume, 0);
}

TEST(MeshVolume, NanComesOutAsNan) {
  Mesh mesh = cube();
  mesh.positions[5].y() = std::numeric_limits<double>::quiet_NaN();
  const MeshVolume measured = mesh.measured();
  EXPECT_TRUE(std::isnan(measured.volume));
  EXPECT_FALSE(measured.closed);
}

}  // namespace
}  // namespace krok
