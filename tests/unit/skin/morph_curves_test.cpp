// If these fail, a morph target shows more or less than its keys say, or keys that cannot be are
// taken for a curve.

#include "skin/morph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace krok {
namespace {

MorphCurve curve(std::vector<double> times, std::vector<double> weights,
                 WeightJoin join = WeightJoin::linear, double tension = 0) {
  MorphCurve made{std::move(times), std::move(weights), {}};
  join_keys(made, join, tension);
  return made;
}

TEST(MorphCurves, LinearIsTheChord) {
  const MorphCurve one = curve({0.5, 1, 3}, {2, 4, 0});
  EXPECT_EQ(weight_at(one, 0.5), 2);
  EXPECT_EQ(weight_at(one, 1), 4);
  EXPECT_DOUBLE_EQ(weight_at(one, 0.75), 3);
  EXPECT_DOUBLE_EQ(weight_at(one, 2.5), 1);
}

TEST(MorphCurves, EndsHoldAndNoKeysAreZero) {
  for (const WeightJoin join : {WeightJoin::linear, WeightJoin::smooth, WeightJoin::monotone}) {
    const MorphCurve one = curve({1, 2}, {0.25, 0.75}, join);
    EXPECT_EQ(weight_at(one, 0), 0.25);
    EXPECT_EQ(weight_at(one, 9), 0.75);
    EXPECT_EQ(weight_at(one, std::numeric_limits<double>::quiet_NaN()), 0.25);
    EXPECT_EQ(weight_at(curve({1}, {0.5}, join), 7), 0.5);
    EXPECT_EQ(weight_at(curve({}, {}, join), 7), 0);
  }
}

// A Catmull-Rom curve goes through samples of a parabola exactly, away from its ends.
TEST(MorphCurves, SmoothFollowsAParabola) {
  MorphCurve one;
  for (int i = 0; i <= 5; ++i) {
    one.times.push_back(0.5 * i);
    one.weights.push_back(0.25 * i * i);
  }
  join_keys(one, WeightJoin::smooth);
  for (double t = 0.5; t <= 2; t += 0.01) EXPECT_NEAR(weight_at(one, t), t * t, 1e-12) << t;
}

TEST(MorphCurves, FullTensionRestsAtKeys) {
  const MorphCurve one = curve({0, 1, 2}, {0, 1, 3}, WeightJoin::smooth, 1);
  for (double t = 0; t <= 1; t += 0.125) {
    EXPECT_NEAR(weight_at(one, t), t * t * (3 - 2 * t), 1e-15);
  }
}

TEST(MorphCurves, MonotoneStaysWithinItsKeysAndSmoothDoesNot) {
  const MorphCurve smooth = curve({0, 1, 2}, {0, 1, 1}, WeightJoin::smooth);
  const MorphCurve monotone = curve({0, 1, 2}, {0, 1, 1}, WeightJoin::monotone);
  double highest = 0;
  for (double t = 0; t <= 2; t += 1 / 64.0) {
    highest = std::max(highest, weight_at(smooth, t));
    EXPECT_LE(weight_at(monotone, t), 1);
    EXPECT_GE(weight_at(monotone, t), 0);
  }
  // 1 + 2/27, as the SPEC of the weights' files has it.
  EXPECT_NEAR(highest, 1 + 2.0 / 27, 1e-3);
}

TEST(MorphCurves, SamplesReachTheLastKey) {
  const MorphCurves curves{{"a", "b"}, {curve({0, 0.1}, {0, 1}), curve({0, 0.25}, {1, 3})}};
  EXPECT_EQ(curves.duration(), 0.25);
  EXPECT_EQ(*frames_of(curves, 10), 4);  // 0, 0.1, 0.2 and one that holds the last key
  EXPECT_EQ(*frames_of(curves, 20), 6);
  const auto weights = sample(curves, 10, 4);
  ASSERT_TRUE(weights.ok());
  EXPECT_EQ(weights->names, curves.names);
  EXPECT_EQ(weights->frame_count(), 4);
  const std::vector<float> expected = {0, 1, 1, 1.8f, 1, 2.6f, 1, 3};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(weights->values[i], expected[i], 1e-6) << i;
  }
}

TEST(MorphCurves, WithoutAKeyOneFrameIsLeft) {
  const MorphCurves curves{{"a"}, {MorphCurve()}};
  EXPECT_EQ(*frames_of(curves, 30), 1);
  EXPECT_EQ(sample(curves, 30, 1)->values, std::vector<float>{0});
}

TEST(MorphCurves, WhatCannotBeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](MorphCurve one) {
    const Status status = check(MorphCurves{{"a"}, {std::move(one)}});
    return !status && status.error().code == "morph-curve";
  };
  EXPECT_FALSE(refused(curve({0, 1}, {0, 1})));
  EXPECT_TRUE(refused(curve({0, 0}, {0, 1})));
  EXPECT_TRUE(refused(curve({1, 0}, {0, 1})));
  EXPECT_TRUE(refused(curve({-1, 0}, {0, 1})));
  EXPECT_TRUE(refused(curve({0, nan}, {0, 1})));
  EXPECT_TRUE(refused(curve({0, 1}, {0, nan})));
  EXPECT_TRUE(refused(MorphCurve{{0, 1}, {0}, {}}));
  EXPECT_FALSE(check(MorphCurves{{"a", "b"}, {MorphCurve()}}).ok());
  const MorphCurves long_one{{"a"}, {curve({0, 1e6}, {0, 1})}};
  EXPECT_EQ(frames_of(long_one, 1000).error().code, "morph-too-long");
  EXPECT_EQ(frames_of(long_one, 0).error().code, "morph-rate");
  EXPECT_EQ(frames_of(long_one, nan).error().code, "morph-rate");
  EXPECT_EQ(sample(long_one, 100, 200'000'000).error().code, "morph-too-long");
}

}  // namespace
}  // namespace krok
