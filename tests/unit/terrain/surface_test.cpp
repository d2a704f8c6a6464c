// If these fail, a page or a chart draws a ground that is not the one a walker stood on: beside its
// height, with rounded steps, without a bridge's underside, or with holes filled.

#include <gmock/gmock.h>

#include <cmath>

#include "terrain/shapes.h"
#include "terrain/spec.h"
#include "terrain/surface.h"

namespace krok::terrain {
namespace {

using Corners = std::array<Vec3, 3>;

std::vector<Corners> corners_of(const Surface& surface) {
  std::vector<Corners> all;
  for (const auto& triangle : surface.triangles) {
    Corners& corners = all.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = surface.positions[triangle[k]].cast<double>();
    }
  }
  return all;
}

// The height of the highest triangle above (x, z); empty where there is none.
std::optional<double> height_at(const std::vector<Corners>& triangles, double x, double z) {
  std::optional<double> height;
  for (const Corners& t : triangles) {
    const auto side = [&](const Vec3& a, const Vec3& b) {
      return (b.z() - a.z()) * (x - a.x()) - (b.x() - a.x()) * (z - a.z());
    };
    const double u = side(t[1], t[2]), v = side(t[2], t[0]), w = side(t[0], t[1]);
    const double sum = u + v + w;
    if (u < 0 || v < 0 || w < 0 || !(sum > 1e-9)) continue;
    const double here = (u * t[0].y() + v * t[1].y() + w * t[2].y()) / sum;
    if (!height || here > *height) height = here;
  }
  return height;
}

// The largest difference to the ground itself, at places that are on no line.
double largest_miss(const Terrain& ground, const SurfaceOptions& options) {
  const auto surface = surface_of(ground, options);
  EXPECT_TRUE(surface) << surface.error().message;
  const auto triangles = corners_of(*surface);
  double largest = 0;
  for (double x = options.low.x() + 0.013; x < options.high.x(); x += 0.171) {
    for (double z = options.low.y() + 0.017; z < options.high.y(); z += 0.0573) {
      const auto real = ground.at(x, z);
      const auto drawn = height_at(triangles, x, z);
      EXPECT_EQ(real.has_value(), drawn.has_value()) << x << " " << z;
      if (real && drawn) largest = std::max(largest, std::abs(real->height - *drawn));
    }
  }
  return largest;
}

const SurfaceOptions kWalk{.low = Vec2(-1.03, -0.91), .high = Vec2(1.21, 4.07)};

TEST(Surface, HasTheGroundsHeights) {
  for (const char* spec :
       {"level:height=3cm", "stairs", "stairs:rise=-20cm,run=5cm,count=30", "slope:12deg",
        "slope:-30deg,begin=0.377m", "rough", "rough:height=30cm"}) {
    SCOPED_TRACE(spec);
    const auto ground = from_spec(spec);
    ASSERT_TRUE(ground);
    EXPECT_LT(largest_miss(**ground, kWalk), 0.002);
  }
}

TEST(Surface, IsAsCoarseAsTheGroundAllows) {
  EXPECT_EQ(surface_of(**from_spec("level"), kWalk)->triangles.size(), 2U);
  // Two parts, which meet at the crease.
  const auto slope = surface_of(**from_spec("slope:12deg"), kWalk);
  EXPECT_LE(slope->triangles.size(), 12U);
  // A tread and a riser for each of ten steps, and both landings.
  const auto stairs = surface_of(**from_spec("stairs:count=10"), kWalk);
  EXPECT_LE(stairs->triangles.size(), 2U * (2 * 10 + 2));
}

TEST(Surface, KeepsTheEdgesOfStairs) {
  const auto stairs = surface_of(**from_spec("stairs:rise=17cm,run=29cm,count=5"), kWalk);
  ASSERT_TRUE(stairs);
  int upright = 0;
  for (const Vec3f& normal : stairs->normals) {
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
    const bool is_tread = normal.y() > 0.9999F;
    upright += is_tread ? 0 : 1;
    EXPECT_TRUE(is_tread || normal.z() < -0.9999F) << normal.transpose();
  }
  EXPECT_EQ(upright, 5 * 4);
  // Each riser is upright where it is to be.
  for (int k = 0; k < 5; ++k) {
    int there = 0;
    for (const Vec3f& at : stairs->positions) there += std::abs(at.z() - (1 + 0.29F * k)) < 1e-5F;
    EXPECT_EQ(there, 8) << k;
  }
}

TEST(Surface, LeavesHolesOpen) {
  HeightField field;
  field.columns = 41;
  field.rows = 51;
  field.width = 4;
  field.depth = 5;
  field.centre_z = 2;
  for (int r = 0; r < field.rows; ++r) {
    for (int c = 0; c < field.columns; ++c) {
      const bool hole = r > 20 && r < 27 && c > 12 && c < 30;
      field.heights.push_back(hole ? NAN : 0.1F * std::sin(0.3F * static_cast<float>(r + c)));
    }
  }
  const auto ground = height_field(field);
  ASSERT_TRUE(ground);
  EXPECT_LT(largest_miss(**ground, kWalk), 0.002);
  // Beyond the field there is nothing to show.
  const auto far = surface_of(**ground, {.low = Vec2(10, 10), .high = Vec2(12, 12)});
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, "ground-empty");
}

// A bridge over level ground, with a wall.
std::vector<GroundTriangle> bridge() {
  const auto square = [](std::vector<GroundTriangle>& into, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    into.push_back({a, b, c});
    into.push_back({a, c, d});
  };
  std::vector<GroundTriangle> all;
  square(all, {-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9});
  square(all, {-0.5, 1, 1}, {-0.5, 1, 2}, {0.5, 1, 2}, {0.5, 1, 1});
  square(all, {-0.5, 1, 1}, {0.5, 1, 1}, {0.5, 2, 1}, {-0.5, 2, 1});
  return all;
}

TEST(Surface, OfAMeshIsTheMeshCutAtTheRectangle) {
  const auto ground = mesh_ground(bridge());
  ASSERT_TRUE(ground);
  const auto surface = surface_of(**ground, kWalk);
  ASSERT_TRUE(surface);
  double area = 0;
  for (const Corners& t : corners_of(*surface)) {
    area += (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2;
  }
  EXPECT_NEAR(area, 2.24 * 4.98 + 1 + 1, 1e-4);  // below the bridge, too, and its wall
  for (const Vec3f& at : surface->positions) {
    EXPECT_GE(at.x(), -1.0301F);
    EXPECT_LE(at.z(), 4.0701F);
  }
  EXPECT_LT(largest_miss(**ground, kWalk), 1e-5);
  // What has too many triangles is sampled: the bridge hides what is below, the rest is there.
  SurfaceOptions few = kWalk;
  few.triangles = 1;
  const auto sampled = surface_of(**ground, few);
  ASSERT_TRUE(sampled);
  EXPECT_NEAR(*height_at(corners_of(*sampled), -0.9, 3.5), 0, 1e-6);
}

TEST(Surface, OfMuchRoughGroundIsCoarserWithinTheLimit) {
  SurfaceOptions large{.low = Vec2(-60, -60), .high = Vec2(60, 60)};
  const auto surface = surface_of(**from_spec("rough"), large);
  ASSERT_TRUE(surface);
  EXPECT_LE(surface->triangles.size(), 200'000U);
  EXPECT_GT(surface->triangles.size(), 1000U);
}

TEST(Surface, NeedsARectangle) {
  for (const Vec2& high : {Vec2(-1, 1), Vec2(1, NAN), Vec2(1e7, 1)}) {
    const auto surface = surface_of(**from_spec("level"), {.low = Vec2(-1, -1), .high = high});
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().code, "ground-value");
  }
}

}  // namespace
}  // namespace krok::terrain
