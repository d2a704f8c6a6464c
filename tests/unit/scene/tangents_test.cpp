// If these fail, normal textures are lit from the wrong side on meshes that came without tangents.

#include "scene/tangents.h"

#include <gtest/gtest.h>

#include <cmath>

namespace krok {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// A quad of two triangles facing +Z with u to the right and v down, as a picture hangs on a wall.
const std::vector<Vec3f> kPlaces = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
const std::vector<Vec3f> kNormals(4, Vec3f(0, 0, 1));
const std::vector<Vec2f> kHanging = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
const Triangles kFaces = {{0, 1, 2}, {0, 2, 3}};

TEST(MakeTangents, AImageOnAWallHasItsRightAndItsTop) {
  for (const Vec4f& tangent : make_tangents(kPlaces, kNormals, kHanging, kFaces)) {
    EXPECT_LT((tangent.head<3>() - Vec3f(1, 0, 0)).norm(), 1e-6f);
    // normal x tangent is +Y, which is where the picture's top is.
    EXPECT_EQ(tangent.w(), 1);
  }
}

TEST(MakeTangents, AMirroredImageIsOnTheOtherSide) {
  std::vector<Vec2f> mirrored = kHanging;
  for (Vec2f& coordinate : mirrored) coordinate.x() = 1 - coordinate.x();
  for (const Vec4f& tangent : make_tangents(kPlaces, kNormals, mirrored, kFaces)) {
    EXPECT_LT((tangent.head<3>() - Vec3f(-1, 0, 0)).norm(), 1e-6f);
    EXPECT_EQ(tangent.w(), -1);
  }
}

// On a cylinder wrapped in a picture, the tangent at angle a is (-sin a, 0, -cos a) where u grows
// against a, whatever the height.
TEST(MakeTangents, OnACylinderTheyGoRound) {
  constexpr int kSides = 64;
  std::vector<Vec3f> places, normals;
  std::vector<Vec2f> coordinates;
  Triangles faces;
  for (int i = 0; i <= kSides; ++i) {
    const double angle = 2 * kPi * i / kSides;
    for (const float y : {0.0f, 1.0f}) {
      normals.emplace_back(std::sin(angle), 0, std::cos(angle));
      places.push_back(3 * normals.back() + Vec3f(0, y, 0));
      coordinates.emplace_back(static_cast<float>(i) / kSides, 1 - y);
    }
    if (i == kSides) break;
    const auto at = static_cast<std::uint32_t>(2 * i);
    faces.push_back({at, at + 2, at + 3});
    faces.push_back({at, at + 3, at + 1});
  }
  const auto tangents = make_tangents(places, normals, coordinates, faces);
  for (std::size_t v = 0; v < places.size(); ++v) {
    const Vec3f around(normals[v].z(), 0, -normals[v].x());
    EXPECT_GT(tangents[v].head<3>().dot(around), 0.999f) << v;
    EXPECT_NEAR(tangents[v].head<3>().dot(normals[v]), 0, 1e-6) << v;
    EXPECT_NEAR(tangents[v].head<3>().norm(), 1, 1e-6) << v;
    EXPECT_EQ(tangents[v].w(), 1) << v;
  }
}

TEST(MakeTangents, WithoutADirectionSomeOneIsTaken) {
  const std::vector<Vec2f> same(4, Vec2f(0.5f, 0.5f));
  for (const auto& faces : {kFaces, Triangles(), Triangles{{0, 0, 0}}}) {
    for (const Vec4f& tangent : make_tangents(kPlaces, kNormals, same, faces)) {
      EXPECT_NEAR(tangent.head<3>().norm(), 1, 1e-6);
      EXPECT_NEAR(tangent.z(), 0, 1e-6);
      EXPECT_EQ(std::abs(tangent.w()), 1);
    }
  }
  EXPECT_TRUE(make_tangents({}, {}, {}, {}).empty());
}

}  // namespace
}  // namespace krok
