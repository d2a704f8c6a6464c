// If these fail, figures and places of differences are wrong, or a NaN passes for the same.

#include "compare/measure.h"

#include <gtest/gtest.h>

#include <limits>

namespace krok::compare {
namespace {

TEST(Measure, KeepsLargestItsPlaceRmsAndCountOver) {
  Measure measure(2.0);
  measure.add(3, ValueLocation{.vertex = 7});
  measure.add(0, ValueLocation{.vertex = 8});
  measure.add(4, ValueLocation{.vertex = 9});
  measure.add(4, ValueLocation{.vertex = 10});
  EXPECT_EQ(measure.largest, 4);
  EXPECT_EQ(measure.where.vertex, 9);
  EXPECT_EQ(measure.count, 4);
  EXPECT_EQ(measure.over, 3);
  EXPECT_DOUBLE_EQ(measure.rms(), std::sqrt(41.0 / 4.0));
  EXPECT_FALSE(measure.within());
}

TEST(Measure, ADifferenceEqualToTheToleranceIsWithin) {
  Measure measure(0.5);
  measure.add(0.5, {});
  EXPECT_TRUE(measure.within());
  Measure exact(0.0);
  exact.add(0.0, {});
  EXPECT_TRUE(exact.within());
  exact.add(1e-300, {});
  EXPECT_FALSE(exact.within());
}

TEST(Measure, WhatIsNotANumberIsBeyondEveryTolerance) {
  Measure measure(1e300);
  measure.add(std::numeric_limits<double>::quiet_NaN(), ValueLocation{.joint = 3});
  EXPECT_FALSE(measure.within());
  EXPECT_EQ(measure.where.joint, 3);
}

TEST(Measure, MergingIsAddingInOrder) {
  Measure whole(1), first(1), second(1);
  for (int i = 0; i < 10; ++i) {
    const double value = (i * 7) % 5;
    whole.add(value, ValueLocation{.vertex = i});
    (i < 5 ? first : second).add(value, ValueLocation{.vertex = i});
  }
  first.merge(second);
  EXPECT_EQ(first.largest, whole.largest);
  EXPECT_EQ(first.where.vertex, whole.where.vertex);
  EXPECT_EQ(first.over, whole.over);
  EXPECT_EQ(first.count, whole.count);
  EXPECT_DOUBLE_EQ(first.rms(), whole.rms());
}

TEST(Measure, NothingMeasuredHasNoRms) {
  EXPECT_EQ(Measure(1).rms(), 0.0);
}

TEST(AngleBetweenDirections, IsAccurateAtBothEndsAndDefinedForZero) {
  const Vec3 x(1, 0, 0);
  EXPECT_NEAR(angle_between_directions(x, Vec3(1, 1e-9, 0)), 1e-9, 1e-20);
  EXPECT_NEAR(angle_between_directions(x, Vec3(-1, 1e-9, 0)), kPi - 1e-9, 1e-15);
  EXPECT_NEAR(angle_between_directions(x, Vec3(0, 5, 0)), kPi / 2, 1e-15);
  EXPECT_EQ(angle_between_directions(x, 3 * x), 0.0);
  EXPECT_EQ(angle_between_directions(Vec3::Zero(), Vec3::Zero()), 0.0);
  EXPECT_EQ(angle_between_directions(Vec3::Zero(), x), kPi);
}

}  // namespace
}  // namespace krok::compare
