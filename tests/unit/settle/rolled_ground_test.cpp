// If these fail, bodies sink into stairs, hover over plain ground, or jump at edges.

#include <gtest/gtest.h>

#include <cmath>

#include "settle/settler_internal.h"
#include "terrain/spec.h"

namespace krok::settling {
namespace {

constexpr double kAnyHeight = 100;

TEST(RolledGround, IsARampOverStairsAndNowhereBelowThem) {
  const auto stairs = *terrain::from_spec("stairs:rise=17cm,run=29cm,count=40,begin=-4m");
  const RolledGround rolled(*stairs, Vec2(-0.5, -1), Vec2(0.5, 1));
  ASSERT_TRUE(rolled.has_steps());
  double before = 0;
  for (int i = 0; i <= 400; ++i) {
    const double z = -1 + 0.005 * i;
    const double height = rolled.at(0.1, z, kAnyHeight)->height;
    EXPECT_GE(height, stairs->at(0.1, z, kAnyHeight)->height) << z;
    // The line through the edges: a rise before each run.
    const double edges = 0.17 * ((z + 4) / 0.29 + 1);
    EXPECT_GT(height, edges - 0.009) << z;  // it sags between them
    EXPECT_LT(height, edges + 0.004) << z;
    if (i > 0) {
      EXPECT_LT(std::abs(height - before), 0.03) << z;
    }
    before = height;
  }
}

// A round edge of 1 cm, half of it beside the edge of a step, and 3 mm in it.
TEST(SettleClearance, SeesTheEdgeOfAStepBesideASmallSphere) {
  const auto step = *terrain::from_spec("stairs:rise=17cm,run=29cm,count=1,begin=0m");
  EXPECT_LT(clearance(*step, Vec3(0, 0.176, -0.005), 0.01), -0.001);
  EXPECT_GT(clearance(*step, Vec3(0, 0.181, -0.005), 0.01), 0.001);
}

TEST(RolledGround, SlopesAreNoSteps) {
  for (const char* spec :
       {"level:height=1m", "slope:40deg,begin=-9m", "rough:seed=3,height=12cm"}) {
    const auto ground = *terrain::from_spec(spec);
    // A large rectangle has larger cells.
    for (const double reach : {1.0, 30.0}) {
      const RolledGround rolled(*ground, Vec2::Constant(-reach), Vec2::Constant(reach));
      EXPECT_FALSE(rolled.has_steps()) << spec << ' ' << reach;
    }
  }
}

}  // namespace
}  // namespace krok::settling
