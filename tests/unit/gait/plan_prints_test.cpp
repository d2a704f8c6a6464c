// If these fail, a walker is asked for steps that no one wishes: uneven, beside the path, on edges.
#include "gait/plan_prints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "terrain/shapes.h"
#include "terrain/spec.h"

namespace krok::gait {
namespace {

std::unique_ptr<Terrain> ground_of(std::string_view spec) {
  return *terrain::from_spec(spec);
}

Path straight(double length) {
  return *Path::create(std::vector<PathPoint>{{0, 0, {}}, {0, length, {}}});
}

// Along the path's direction and across it, from one print to the next.
Vec2 step_between(const Print& from, const Print& to) {
  const double x = to.x - from.x, z = to.z - from.z;
  return {z * std::cos(from.heading) + x * std::sin(from.heading),
          x * std::cos(from.heading) - z * std::sin(from.heading)};
}

// What holds of every plan: sides alternate, it begins and ends with both feet side by side.
void expect_a_walk(const std::vector<Print>& prints, const PlanOptions& options) {
  ASSERT_GE(prints.size(), 4U);
  EXPECT_EQ(prints[0].side, options.first);
  for (std::size_t i = 1; i < prints.size(); ++i) EXPECT_NE(prints[i].side, prints[i - 1].side);
  for (const std::size_t i : {std::size_t{1}, prints.size() - 1}) {
    EXPECT_NEAR(step_between(prints[i - 1], prints[i]).x(), 0, 1e-5);
    const double side = prints[i].side == FootSide::left ? 1 : -1;
    EXPECT_NEAR(step_between(prints[i - 1], prints[i]).y(), side * options.step_width, 1e-5);
  }
}

// Would fail if steps on a straight way differed, or were not as long as asked, or the feet lay on
// the wrong side: the left one is towards +X of a walker that faces +Z.
TEST(PlanPrints, StraightWaysHaveEqualSteps) {
  const PlanOptions options;
  const auto plan = plan_prints(straight(10), *ground_of("level"), options);
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_FALSE(plan->fitted_to_ground);
  expect_a_walk(plan->prints, options);
  EXPECT_EQ(plan->prints.size(), 2U + 15 + 1);  // 10 / 0.65 is 15.4
  for (std::size_t i = 2; i + 1 < plan->prints.size(); ++i) {
    EXPECT_NEAR(step_between(plan->prints[i - 1], plan->prints[i]).x(), 10.0 / 15, 2e-6);
    EXPECT_DOUBLE_EQ(plan->prints[i].x, plan->prints[i].side == FootSide::left ? 0.1 : -0.1);
    EXPECT_EQ(plan->prints[i].heading, 0);
    EXPECT_FALSE(plan->prints[i].height);
    EXPECT_FALSE(plan->prints[i].time);
  }
}

// Would fail if steps in curves were not shorter, or turned by more than is allowed.
TEST(PlanPrints, StepsAreShorterInCurves) {
  PlanOptions options;
  options.first = FootSide::right;
  options.toe_out = {0.1, -0.1};
  const std::vector<PathPoint> corner = {{0, 0, {}}, {0, 4, {}}, {4, 4, {}}};
  const auto plan = plan_prints(*Path::create(corner), *ground_of("level"), options);
  ASSERT_TRUE(plan) << plan.error().message;
  for (Print print : plan->prints)
    EXPECT_TRUE(print.heading > -0.2 && print.heading < kPi / 2 + 0.2);
  double total = 0, shortest = 1;
  for (std::size_t i = 2; i + 1 < plan->prints.size(); ++i) {
    const Print& from = plan->prints[i - 1];
    const Print& to = plan->prints[i];
    const double toes = to.side == FootSide::left ? 0.2 : -0.2;
    const double turn = to.heading - from.heading - toes;
    EXPECT_LT(std::abs(turn), options.max_turn + 1e-6);
    total += turn;
    shortest = std::min(shortest, std::hypot(to.x - from.x, to.z - from.z));
  }
  EXPECT_NEAR(total, kPi / 2, 1e-5);
  EXPECT_LT(shortest, 0.5);
}

// Would fail if a sole lay across a stair's edge, a tread were left out, or the way ended on one.
TEST(PlanPrints, StairsHaveAFootOnEachTread) {
  for (const char* spec :
       {"stairs:rise=17cm,run=29cm,count=12", "stairs:rise=-17cm,run=29cm,count=12",
        "stairs:rise=20cm,run=26cm,count=12"}) {
    const auto stairs = ground_of(spec);
    const PlanOptions options;
    const auto plan = plan_prints(straight(7), *stairs, options);
    ASSERT_TRUE(plan) << spec << plan.error().message;
    EXPECT_TRUE(plan->fitted_to_ground);
    expect_a_walk(plan->prints, options);
    for (std::size_t i = 2; i < plan->prints.size(); ++i) {
      const Print& print = plan->prints[i];
      const double heel = stairs->at(print.x, print.z)->height;
      EXPECT_EQ(heel, stairs->at(print.x, print.z + options.heel_to_ball)->height) << print.z;
      EXPECT_LE(stairs->at(print.x, print.z + options.heel_to_toes)->height, heel) << print.z;
      const double before = stairs->at(plan->prints[i - 1].x, plan->prints[i - 1].z)->height;
      EXPECT_LE(std::abs(heel - before), 0.2001);
      if (i + 1 == plan->prints.size()) continue;
      const double step = step_between(plan->prints[i - 1], print).x();
      EXPECT_GE(step, options.min_step - 1e-6);
      EXPECT_LE(step, options.max_step + 1e-6);
    }
  }
}

// Would fail if stairs were refused whose treads are shorter than the sole: heels stand out.
TEST(PlanPrints, HeelsStandOutOverShortTreads) {
  for (const char* spec : {"stairs:rise=17cm,run=29cm,count=8", "stairs:rise=17cm,run=26cm"}) {
    const auto stairs = ground_of(spec);
    PlanOptions options;
    options.heel_to_ball = 0.22, options.heel_to_toes = 0.31;
    const auto plan = plan_prints(straight(5), *stairs, options);
    ASSERT_TRUE(plan) << spec << plan.error().message;
    int out = 0;
    for (const Print& print : plan->prints) {
      const double tread = stairs->at(print.x, print.z + options.heel_to_ball)->height;
      EXPECT_EQ(tread, stairs->at(print.x, print.z + 0.4 * options.heel_to_ball)->height);
      EXPECT_EQ(tread, stairs->at(print.x, print.z + 0.95 * options.heel_to_toes)->height);
      EXPECT_EQ(print.height.value_or(tread), tread) << print.z;
      if (stairs->at(print.x, print.z)->height == tread) continue;
      ++out;
      EXPECT_TRUE(print.height.has_value()) << print.z;
    }
    EXPECT_GE(out, 5) << spec;
  }
}

// Would fail if a walk could not end on stairs that it crosses at an angle, where treads have no
// room for two feet side by side: one is then a little ahead, on the same tread if possible.
TEST(PlanPrints, EndsOnStairsCrossedAtAnAngle) {
  const auto stairs = ground_of("stairs:rise=17cm,run=29cm");
  const PlanOptions options;
  for (const double x : {0.0, 0.5, 1.0, 1.5, 2.5}) {
    for (const double z : {3.6, 3.8, 4.0, 4.2}) {
      const auto path = *Path::create(std::vector<PathPoint>{{0, 0, {}}, {x, z, {}}});
      const auto plan = plan_prints(path, *stairs, options);
      ASSERT_TRUE(plan) << x << " " << z << ": " << plan.error().message;
      const Print &last = plan->prints.back(), &before = plan->prints[plan->prints.size() - 2];
      EXPECT_NE(last.side, before.side);
      EXPECT_LT(std::abs(step_between(before, last).x()), 0.3 + 1e-6) << x << " " << z;
      EXPECT_LE(
          std::abs(stairs->at(last.x, last.z)->height - stairs->at(before.x, before.z)->height),
          0.1701);
      EXPECT_LT(std::hypot(last.x - x, last.z - z), 0.75) << x << " " << z;
    }
  }
}

// Stones of 34 cm every 60 cm, nothing between them.
std::unique_ptr<Terrain> stones(int count, double apart) {
  std::vector<terrain::GroundTriangle> mesh;
  for (int i = 0; i < count; ++i) {
    const double z0 = apart * i - 0.1, z1 = z0 + 0.34;
    const Vec3 a(-0.4, 0, z0), b(-0.4, 0, z1), c(0.4, 0, z1), d(0.4, 0, z0);
    mesh.push_back({a, b, c});
    mesh.push_back({a, c, d});
  }
  return *terrain::mesh_ground(mesh);
}

// Would fail if a foot were set into a hole, or a gap that no step crosses were planned over.
TEST(PlanPrints, SteppingStonesAreHit) {
  const PlanOptions options;
  const auto plan = plan_prints(straight(4.8), *stones(9, 0.6), options);
  ASSERT_TRUE(plan) << plan.error().message;
  const auto ground = stones(9, 0.6);
  for (const Print& print : plan->prints) {
    EXPECT_TRUE(ground->at(print.x, print.z)) << print.z;
    EXPECT_TRUE(ground->at(print.x, print.z + options.heel_to_ball)) << print.z;
  }
  const auto wide = plan_prints(straight(4.8), *stones(5, 1.2), options);
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().code, "plan-ground");
  EXPECT_NE(wide.error().message.find("along the path"), std::string::npos);
}

// Would fail if a walk under a bridge were planned onto it.
TEST(PlanPrints, StaysOnItsStorey) {
  std::vector<terrain::GroundTriangle> mesh;
  for (const auto& [y, z0, z1] : {std::array{0.0, -5.0, 20.0}, std::array{2.5, 3.0, 6.0}}) {
    const Vec3 a(-5, y, z0), b(-5, y, z1), c(5, y, z1), d(5, y, z0);
    mesh.push_back({a, b, c});
    mesh.push_back({a, c, d});
  }
  const auto plan = plan_prints(straight(8), **terrain::mesh_ground(mesh), {});
  ASSERT_TRUE(plan) << plan.error().message;
  int under = 0;
  for (const Print& print : plan->prints) {
    const bool below = print.z >= 3 && print.z <= 6;
    EXPECT_EQ(print.height.has_value(), below) << print.z;
    under += below ? 1 : 0;
    EXPECT_EQ(print.height.value_or(0), 0);
  }
  EXPECT_GE(under, 4);
}

TEST(PlanPrints, TimesOfThePathAreThoseOfThePrints) {
  const std::vector<PathPoint> points = {{0, 0, 0.0}, {0, 5, 5.0}};
  const auto plan = plan_prints(*Path::create(points), *ground_of("level"), {});
  ASSERT_TRUE(plan);
  for (std::size_t i = 2; i + 1 < plan->prints.size(); ++i) {
    EXPECT_NEAR(*plan->prints[i].time, plan->prints[i].z, 1e-5);
  }
}

TEST(PlanPrints, RefusesWhatMakesNoSense) {
  const auto level = ground_of("level");
  PlanOptions options;
  options.step_length = 1;
  EXPECT_EQ(plan_prints(straight(5), *level, options).error().code, "plan-options");
  options = {};
  options.max_turn = 0;
  EXPECT_EQ(plan_prints(straight(5), *level, options).error().code, "plan-options");
  EXPECT_EQ(plan_prints(straight(5), *stones(1, 1), {}).error().code, "plan-ground");
  EXPECT_EQ(
      plan_prints(
          straight(5),
          *terrain::mesh_ground({{Vec3(50, 0, 50), Vec3(50, 0, 51), Vec3(51, 0, 51)}}).value(), {})
          .error()
          .code,
      "plan-ground");
}

}  // namespace
}  // namespace krok::gait
