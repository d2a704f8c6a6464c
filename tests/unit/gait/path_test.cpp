// If these fail, a walker leaves the path it was given, or turns where the path does not.
#include "gait/path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/human_skeleton.h"

namespace krok::gait {
namespace {

std::vector<PathPoint> circle(double radius, int pieces) {
  std::vector<PathPoint> points;
  for (int i = 0; i <= pieces; ++i) {
    const double angle = 2 * kPi * i / pieces;
    points.push_back({radius * (1 - std::cos(angle)), radius * std::sin(angle), {}});
  }
  return points;
}

// Would fail if arc length or heading were off: both are known on a circle, which is travelled from
// +Z towards +X, that is with rising heading, over more than half a turn.
TEST(Path, CircleHasItsLengthAndHeading) {
  const auto path = Path::create(circle(2, 720));
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->length(), 4 * kPi, 1e-3);
  for (double at = 0.2; at < path->length() - 0.2; at += 0.0937) {
    const PathPlace place = path->at(at);
    EXPECT_NEAR(place.heading, at / 2, 2e-3);
    EXPECT_NEAR(std::hypot(place.x - 2, place.z), 2, 1e-4);
    EXPECT_NEAR(place.curvature, 0.5, 0.05);
  }
}

// Would fail if a corner made the heading jump, or if it moved the way.
TEST(Path, HeadingIsContinuousAtCorners) {
  const std::vector<PathPoint> points = {
      {0, 0, {}}, {0, 2, {}}, {3, 2, {}}, {3, 2, {}}, {3, -1, {}}};
  const auto path = Path::create(points);
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->length(), 8);
  EXPECT_NEAR(path->at(0).heading, 0, 1e-9);
  EXPECT_NEAR(path->at(3.5).heading, kPi / 2, 1e-9);
  EXPECT_NEAR(path->at(8).heading, kPi, 1e-9);
  EXPECT_NEAR(path->at(2).x, 0, 1e-9);
  EXPECT_NEAR(path->at(2).z, 2, 1e-9);
  for (double at = 0.001; at < 8; at += 0.001) {
    EXPECT_LT(std::abs(path->at(at).heading - path->at(at - 0.001).heading), 0.02);
  }
  EXPECT_DOUBLE_EQ(path->at(-5).z, 0);
  EXPECT_DOUBLE_EQ(path->at(50).z, -1);
}

// Would fail if a way back on itself gave no heading or turned many times round.
TEST(Path, TurnsBack) {
  const auto path = Path::create(std::vector<PathPoint>{{0, 0, {}}, {0, 3, {}}, {0, 1, {}}});
  ASSERT_TRUE(path);
  EXPECT_NEAR(std::abs(path->at(5).heading), kPi, 1e-6);
  EXPECT_NEAR(path->at(2.5).heading, 0, 1e-6);
}

TEST(Path, TimesAreLinearBetweenThoseGiven) {
  const std::vector<PathPoint> points = {
      {0, 0, {}}, {0, 1, 2.0}, {0, 2, {}}, {0, 3, 3.0}, {0, 4, {}}};
  const auto path = Path::create(points);
  ASSERT_TRUE(path);
  EXPECT_FALSE(path->at(0.5).time);
  EXPECT_NEAR(*path->at(1.5).time, 2.25, 1e-12);
  EXPECT_NEAR(*path->at(3).time, 3, 1e-12);
  EXPECT_FALSE(path->at(3.5).time);
}

TEST(Path, RefusesWhatIsNone) {
  const auto code = [](const std::vector<PathPoint>& points) {
    const auto path = Path::create(points);
    return path ? "none" : path.error().code;
  };
  EXPECT_EQ(code({}), "path-short");
  EXPECT_EQ(code({{1, 1, {}}}), "path-short");
  EXPECT_EQ(code({{1, 1, {}}, {1, 1.04, {}}}), "path-short");
  EXPECT_EQ(code({{1, 1, {}}, {1, NAN, {}}}), "path-value");
  EXPECT_EQ(code({{1, 1, {}}, {1e9, 1, {}}}), "path-value");
  EXPECT_EQ(code({{1, 1, 2.0}, {1, 2, 1.0}}), "path-times");
  EXPECT_EQ(code({{1, 1, 2.0}, {1, 2, 2.0}}), "path-times");
}

// Would fail if a way missed its goal, began in another direction, or turned more sharply than it
// may (wherever the goal lies: ahead, beside, behind, near).
TEST(WayToGoals, LeadsThereInArcs) {
  for (const double start : {0.0, 1.0, -2.5}) {
    for (int k = 0; k < 24; ++k) {
      for (const double far : {0.2, 0.7, 1.5, 6.0}) {
        const Vec2 goal(1 + far * std::sin(k), 2 + far * std::cos(k));
        const auto way = way_to_goals(1, 2, start, std::vector<Vec2>{goal}, 0.8);
        ASSERT_GE(way.size(), 2U);
        EXPECT_EQ(way.back().x, goal.x());
        EXPECT_EQ(way.back().z, goal.y());
        const double most = 0.05 * 1.01 + 1e-6;  // what a piece of an arc turns
        double last = start;
        for (std::size_t i = 1; i < way.size(); ++i) {
          const double heading = std::atan2(way[i].x - way[i - 1].x, way[i].z - way[i - 1].z);
          EXPECT_LT(std::abs(std::remainder(heading - last, 2 * kPi)), most) << k << ' ' << far;
          last = heading;
        }
      }
    }
  }
  // Several in a row; a goal where the way is already adds nothing.
  const auto way = way_to_goals(0, 0, 0, std::vector<Vec2>{{0, 2}, {0, 2}, {3, 2}});
  EXPECT_EQ(way.back().x, 3);
  EXPECT_EQ(way_to_goals(0, 0, 0, std::vector<Vec2>{{0, 0}}).size(), 1U);
}

// Would fail if the sway of steps were taken for the way: hips sway 3 cm at one stride a second.
TEST(WayOf, TakesOutTheSway) {
  Clip clip;
  clip.skeleton = krok::test::human_skeleton();
  clip.rate = 60;
  clip.resize(300);
  for (int frame = 0; frame < 300; ++frame) {
    const double time = frame / 60.0;
    clip.frame_positions(frame)[0] =
        Vec3f(static_cast<float>(0.03 * std::sin(2 * kPi * time)), 1, static_cast<float>(time));
  }
  const auto way = way_of(clip, 0);
  ASSERT_GT(way.size(), 40U);
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (way[i].z > 1.2 && way[i].z < 3.8) {
      EXPECT_LT(std::abs(way[i].x), 0.006);
    }
    if (i > 0 && i + 1 < way.size()) {
      EXPECT_NEAR(way[i].z - way[i - 1].z, 0.1, 0.02);
    }
  }
  EXPECT_NEAR(way.front().z, 0, 1e-6);
  EXPECT_NEAR(way.back().z, 299 / 60.0, 1e-5);
}

}  // namespace
}  // namespace krok::gait
