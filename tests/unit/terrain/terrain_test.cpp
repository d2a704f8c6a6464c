// If these fail, a walker's feet are set beside the ground: in the air, in it, or tilted wrongly.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "terrain/shapes.h"
#include "terrain/spec.h"

namespace krok {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::unique_ptr<Terrain> made(std::string_view spec) {
  auto result = terrain::from_spec(spec);
  EXPECT_TRUE(result.ok()) << spec << ": " << (result.ok() ? "" : result.error().message);
  return result.ok() ? std::move(*result) : nullptr;
}

double height(const Terrain& ground, double x, double z) {
  const auto point = ground.at(x, z);
  return point ? point->height : kNaN;
}

// Would fail if the normal were not that of the surface that the heights describe.
void expect_normals_of_heights(const Terrain& ground, double reach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-reach, reach);
  for (int i = 0; i < 500; ++i) {
    const double x = place(random), z = place(random), step = 1e-6;
    const auto point = ground.at(x, z);
    ASSERT_TRUE(point);
    const Vec3 along_x(2 * step, height(ground, x + step, z) - height(ground, x - step, z), 0);
    const Vec3 along_z(0, height(ground, x, z + step) - height(ground, x, z - step), 2 * step);
    EXPECT_LT((along_z.cross(along_x).normalized() - point->normal).norm(), 1e-6);
    EXPECT_GT(point->normal.y(), 0);
  }
}

// Would fail if stairs began elsewhere than a metre ahead, if an edge belonged to the lower tread,
// or if there were no landing.
TEST(Terrain, StairsGoUpFromAMetreAhead) {
  const auto stairs = made("stairs:rise=17cm,run=29cm,count=3");
  EXPECT_EQ(height(*stairs, 5, -100), 0);
  EXPECT_EQ(height(*stairs, 0, 0.999), 0);
  EXPECT_DOUBLE_EQ(height(*stairs, 0, 1), 0.17);
  EXPECT_DOUBLE_EQ(height(*stairs, -9, 1.28), 0.17);
  EXPECT_DOUBLE_EQ(height(*stairs, 0, 1.30), 0.34);
  EXPECT_DOUBLE_EQ(height(*stairs, 0, 1.60), 0.51);
  EXPECT_DOUBLE_EQ(height(*stairs, 0, 100), 0.51);
  const auto down = made("stairs:rise=-20cm,run=30cm");
  EXPECT_EQ(height(*down, 0, 1), 0);
  EXPECT_DOUBLE_EQ(height(*down, 0, 1.001), -0.2);
  EXPECT_DOUBLE_EQ(height(*down, 0, 1.301), -0.4);
  EXPECT_DOUBLE_EQ(height(*down, 0, 1000), -4);
}

// Would fail if the slope's height or normal belonged to another angle.
TEST(Terrain, SlopeRisesByItsAngle) {
  const auto slope = made("slope:30deg");
  EXPECT_EQ(height(*slope, 3, 1), 0);
  EXPECT_NEAR(height(*slope, 3, 3), 2 * std::tan(kPi / 6), 1e-12);
  EXPECT_LT((slope->at(0, 2)->normal - Vec3(0, std::sqrt(0.75), -0.5)).norm(), 1e-12);
  EXPECT_NEAR(height(*made("slope:12%"), 0, 3), 0.24, 1e-12) << "a grade: the rise of the run";
  EXPECT_NEAR(height(*made("slope:-12deg"), 0, 2), -std::tan(12 * kRadiansPerDegree), 1e-12);
  EXPECT_NEAR(height(*made("slope:angle=12deg,begin=4m"), 0, 5), std::tan(12 * kRadiansPerDegree),
              1e-12);
}

// Would fail if rough ground left its height, hardly used it, or was not flat where the walker
// starts; if another run or another machine had another ground (the last value).
TEST(Terrain, RoughGroundKeepsItsPromises) {
  const auto rough = made("rough:seed=1,height=8cm");
  const auto other = made("rough:seed=2,height=8cm");
  double low = 0, high = 0, different = 0;
  for (int i = 0; i < 40000; ++i) {
    const double x = 0.11 * (i % 200) - 11, z = 0.11 * (i / 200) - 11;
    low = std::min(low, height(*rough, x, z));
    high = std::max(high, height(*rough, x, z));
    different = std::max(different, std::abs(height(*rough, x, z) - height(*other, x, z)));
  }
  EXPECT_GE(low, -0.04);
  EXPECT_LE(high, 0.04);
  EXPECT_GT(high - low, 0.05);
  EXPECT_GT(different, 0.03);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(height(*rough, 0.299 * std::cos(i), 0.299 * std::sin(i)), 0);
  }
  expect_normals_of_heights(*rough, 5);
  EXPECT_FALSE(rough->at(1e300, 0));
  EXPECT_DOUBLE_EQ(height(*rough, 3.3, -2.7), height(*made("rough"), 3.3, -2.7));
}

terrain::HeightField hill(int columns, int rows) {
  terrain::HeightField field{columns, rows, {}, 8, 6, 1, 2};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = 1 - 4 + 8.0 * column / (columns - 1), z = 2 - 3 + 6.0 * row / (rows - 1);
      field.heights.push_back(static_cast<float>(0.25 * x - 0.5 * z));
    }
  }
  return field;
}

// Would fail if rows or columns were mirrored, exchanged, or off by half a sample: the heights are
// those of a plane, so they must come back at any place, and nothing beyond the border.
TEST(Terrain, HeightFieldLiesWhereItSays) {
  const auto ground = terrain::height_field(hill(9, 4));
  ASSERT_TRUE(ground);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x_place(-3, 5), z_place(-1, 5);
  for (int i = 0; i < 1000; ++i) {
    const double x = x_place(random), z = z_place(random);
    EXPECT_NEAR(height(**ground, x, z), 0.25 * x - 0.5 * z, 1e-6);
    EXPECT_LT(((*ground)->at(x, z)->normal - Vec3(-0.25, 1, 0.5).normalized()).norm(), 1e-5);
  }
  EXPECT_TRUE((*ground)->at(-3, -1));
  EXPECT_TRUE((*ground)->at(5, 5));
  EXPECT_FALSE((*ground)->at(5.001, 0));
  EXPECT_FALSE((*ground)->at(0, -1.001));
  EXPECT_FALSE((*ground)->at(kNaN, 0));
}

// Would fail if a hole carried, or swallowed more than the squares around it.
TEST(Terrain, HeightFieldHasHoles) {
  terrain::HeightField field{4, 4, std::vector<float>(16, 1.0f), 3, 3};
  field.heights[5] = std::numeric_limits<float>::quiet_NaN();  // at (-0.5, -0.5)
  const auto ground = terrain::height_field(field);
  ASSERT_TRUE(ground);
  EXPECT_FALSE((*ground)->at(-0.5, -0.5));
  EXPECT_FALSE((*ground)->at(-1.4, 0.4));
  EXPECT_TRUE((*ground)->at(0.6, 0));
  EXPECT_TRUE((*ground)->at(0, 0.6));
}

// Would fail if a field that makes no sense were taken, or all of them refused for another reason.
TEST(Terrain, HeightFieldRefuses) {
  EXPECT_EQ(terrain::height_field({1, 1, {0}, 1, 1}).error().code, "ground-size");
  EXPECT_EQ(terrain::height_field({2, 2, {0, 0, 0}, 1, 1}).error().code, "ground-size");
  EXPECT_EQ(terrain::height_field({1 << 16, 1 << 16, {}, 1, 1}).error().code, "ground-size");
  EXPECT_EQ(terrain::height_field({2, 2, {0, 0, 0, 0}, 1, 0}).error().code, "ground-size");
  EXPECT_EQ(terrain::height_field({2, 2, {0, 0, 0, 0}, kNaN, 1}).error().code, "ground-size");
  const float hole = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(terrain::height_field({2, 2, {hole, hole, hole, hole}, 1, 1}).error().code,
            "ground-empty");
  const auto infinite =
      terrain::height_field({2, 2, {0, 0, 0, std::numeric_limits<float>::infinity()}, 1, 1});
  ASSERT_FALSE(infinite);
  EXPECT_EQ(infinite.error().message, "the height in column 1, row 1 is infinite");
}

// Two triangles facing up, or down.
void add_quad(std::vector<terrain::GroundTriangle>& mesh, double x0, double z0, double x1,
              double z1, double y, bool up) {
  const Vec3 a(x0, y, z0), b(x0, y, z1), c(x1, y, z1), d(x1, y, z0);
  mesh.push_back({a, up ? b : c, up ? c : b});
  mesh.push_back({a, up ? c : d, up ? d : c});
}

// Would fail if a walker on the bridge were set below it, one below it on it, or if the underside
// of the bridge carried.
TEST(Terrain, MeshHasStoreys) {
  std::vector<terrain::GroundTriangle> mesh;
  add_quad(mesh, -5, -5, 5, 5, 0, true);
  add_quad(mesh, -1, -5, 1, 5, 3, true);
  add_quad(mesh, -1, -5, 1, 5, 2.8, false);
  bool reversed = true;
  const auto ground = terrain::mesh_ground(mesh, &reversed);
  ASSERT_TRUE(ground);
  EXPECT_FALSE(reversed);
  EXPECT_EQ(height(**ground, 0.3, 0.2), 3);
  EXPECT_EQ((*ground)->at(0.3, 0.2, 3.0)->height, 3);
  EXPECT_EQ((*ground)->at(0.3, 0.2, 2.999)->height, 0);
  EXPECT_EQ((*ground)->at(0.3, 0.2, 2.85)->height, 0);
  EXPECT_EQ(height(**ground, 2, 0.2), 0);
  EXPECT_FALSE((*ground)->at(0.3, 0.2, -0.001));
  EXPECT_FALSE((*ground)->at(6, 0));
}

// Would fail if rays fell through where triangles touch, or if heights were those of floats: the
// hill lies far from the origin, where floats are 1 cm apart.
TEST(Terrain, MeshHasNoGapsAndFullAccuracy) {
  const double far = 100000;
  const auto wave = [](double x, double z) { return 0.3 * std::sin(x) * std::cos(1.3 * z); };
  std::vector<terrain::GroundTriangle> mesh;
  const int cells = 60;
  const auto corner = [&](int i, int k) {
    const double x = 0.1 * i, z = 0.1 * k;
    return Vec3(far + x, wave(x, z), far + z);
  };
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      mesh.push_back({corner(i, k), corner(i, k + 1), corner(i + 1, k + 1)});
      mesh.push_back({corner(i, k), corner(i + 1, k + 1), corner(i + 1, k)});
    }
  }
  const auto ground = terrain::mesh_ground(mesh);
  ASSERT_TRUE(ground);
  for (int i = 1; i < cells; ++i) {
    for (int k = 1; k < cells; ++k) {
      const Vec3 here = corner(i, k), there = corner(i + 1, k + 1);
      EXPECT_NEAR(height(**ground, here.x(), here.z()), here.y(), 1e-9);
      const Vec3 middle = 0.5 * (here + there);
      if (i + 1 == cells || k + 1 == cells) continue;
      EXPECT_NEAR(height(**ground, middle.x(), middle.z()), middle.y(), 1e-9);
    }
  }
}

// Would fail if a mesh wound the other way round did not carry, or walls did.
// If this fails, walkers go through walls, or stop at what is overhead.
TEST(Terrain, MeshBlocksTheWayThroughWallsOnly) {
  const auto quad = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    return std::vector<terrain::GroundTriangle>{{a, b, c}, {a, c, d}};
  };
  std::vector<terrain::GroundTriangle> mesh = quad({-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5});
  for (const auto& triangle : quad({-5, 0, 2}, {5, 0, 2}, {5, 2.5, 2}, {-5, 2.5, 2})) {
    mesh.push_back(triangle);
  }
  const auto ground = terrain::mesh_ground(mesh);
  ASSERT_TRUE(ground.ok());
  EXPECT_TRUE((*ground)->is_blocked({0, 1, 1}, {0, 1, 3}));
  EXPECT_TRUE((*ground)->is_blocked({0, 1, 3}, {0, 1, 1})) << "from behind";
  EXPECT_FALSE((*ground)->is_blocked({0, 1, 1}, {0, 1, 1.9}));
  EXPECT_FALSE((*ground)->is_blocked({0, 2.6, 1}, {0, 2.6, 3})) << "over it";
  EXPECT_FALSE((*ground)->is_blocked({0, NAN, 1}, {0, 1, 3}));
  // It stands on the floor, which goes on below it and is no less ground for that.
  EXPECT_NEAR((*ground)->at(0, 2, 1)->height, 0, 1e-9);
}

TEST(Terrain, MeshThatFacesDownIsTurned) {
  std::vector<terrain::GroundTriangle> mesh;
  add_quad(mesh, 0, 0, 1, 1, 0.5, false);
  bool reversed = false;
  const auto ground = terrain::mesh_ground(mesh, &reversed);
  ASSERT_TRUE(ground);
  EXPECT_TRUE(reversed);
  EXPECT_EQ((*ground)->at(0.5, 0.25)->normal, Vec3::UnitY());
  EXPECT_EQ(terrain::mesh_ground({{Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0)}}).error().code,
            "ground-empty");
  EXPECT_EQ(terrain::mesh_ground({}).error().code, "ground-empty");
  EXPECT_EQ(terrain::mesh_ground({{Vec3(0, 0, 0), Vec3(0, kNaN, 1), Vec3(1, 0, 1)}}).error().code,
            "ground-value");
}

// Would fail if a mistyped ground were guessed at, or its message said nothing of what is allowed.
TEST(Terrain, SpecsSayWhatIsWrong) {
  const auto refused = [](std::string_view spec, std::string_view code, std::string_view words) {
    const auto result = terrain::from_spec(spec);
    ASSERT_FALSE(result.ok()) << spec;
    EXPECT_EQ(result.error().code, code) << spec;
    const std::string all = result.error().message + " | " + result.error().hint;
    EXPECT_NE(all.find(words), std::string::npos) << all;
  };
  refused("stars:rise=1cm", "ground-kind", "did you mean 'stairs'");
  refused("", "ground-kind", "level, stairs, slope, rough");
  refused("stairs:riss=1cm", "ground-key", "did you mean 'rise'");
  refused("stairs:rise=1cm,", "ground-key", "NAME=VALUE");
  refused("stairs:17cm", "ground-key", "NAME=VALUE");
  refused("stairs:rise=1cm,rise=2cm", "ground-key", "twice");
  refused("stairs:rise=1kg", "ground-value", "use one of m, dm");
  refused("stairs:rise=0", "ground-value", "rise");
  refused("stairs:rise=2m", "ground-value", "at most 1 m");
  refused("stairs:run=1cm", "ground-value", "5 cm");
  refused("stairs:count=1.5", "ground-value", "whole number");
  refused("slope", "ground-key", "slope:12deg");
  refused("slope:70deg", "ground-value", "too steep");
  refused("slope:nan", "ground-value", "not a number");
  refused("rough:height=-1cm", "ground-value", "0 to 10");
  refused("rough:seed=x", "ground-value", "whole number");
  EXPECT_TRUE(terrain::is_spec("rough"));
  EXPECT_TRUE(terrain::is_spec("stairs:anything"));
  EXPECT_FALSE(terrain::is_spec("hills.exr"));
  EXPECT_EQ(height(*made("level:height=10cm"), 4, 4), 0.1);
  EXPECT_FALSE(made("level:height=10cm")->at(4, 4, 0.09));
}

}  // namespace
}  // namespace krok
