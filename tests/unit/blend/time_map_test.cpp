// If these fail, motions are blended at moments that do not belong together, or a blend's keytimes
// are not the weighted sums of its motions'.

#include "blend/time_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace krok::blend {
namespace {

const std::vector<double> kSlow = {0.5, 1.1, 1.5, 2.9};
const std::vector<double> kQuick = {0.0, 0.2, 0.9, 1.3};

TEST(TimeMap, GoesThroughItsMomentsAndRises) {
  for (const Warp warp : {Warp::pchip, Warp::linear}) {
    const TimeMap map(kSlow, warp);
    for (std::size_t i = 0; i < kSlow.size(); ++i) {
      EXPECT_DOUBLE_EQ(map.at(static_cast<double>(i)), kSlow[i]);
    }
    EXPECT_EQ(map.at(-1), kSlow.front());
    EXPECT_EQ(map.at(9), kSlow.back());
    for (double g = 0.001; g <= 3; g += 0.001) {
      EXPECT_GT(map.at(g), map.at(g - 0.001)) << g;
      if (std::abs(g - std::round(g)) < 0.002) continue;
      const double measured = (map.at(g + 1e-6) - map.at(g - 1e-6)) / 2e-6;
      EXPECT_NEAR(map.slope(g), measured, 1e-6) << g;
    }
  }
}

// What linear warping has and a monotone cubic has not.
TEST(TimeMap, SpeedsJumpOnlyWhereLinesMeet) {
  const auto jump = [](const TimeMap& map, double at) {
    return std::abs(map.slope(at + 1e-9) - map.slope(at - 1e-9));
  };
  EXPECT_LT(jump(TimeMap(kSlow, Warp::pchip), 2), 1e-6);
  EXPECT_NEAR(jump(TimeMap(kSlow, Warp::linear), 2), 1.0, 1e-6);
}

BlendTime blend_of(const WeightCurve& slow, const WeightCurve& quick, Warp warp = Warp::pchip) {
  auto time = BlendTime::create({TimeMap(kSlow, warp), TimeMap(kQuick, warp)}, {slow, quick}, 0.01);
  EXPECT_TRUE(time.ok()) << (time.ok() ? "" : time.error().message);
  return *time;
}

TEST(BlendTime, MomentsAreWeightedSums) {
  for (const Warp warp : {Warp::pchip, Warp::linear}) {
    for (const double weight : {0.0, 0.3, 1.0, 1.2}) {
      const BlendTime time =
          blend_of(WeightCurve::constant(weight), WeightCurve::constant(1 - weight), warp);
      for (std::size_t i = 0; i < kSlow.size(); ++i) {
        EXPECT_NEAR(time.moments()[i],
                    weight * (kSlow[i] - kSlow[0]) + (1 - weight) * (kQuick[i] - kQuick[0]), 1e-12);
        EXPECT_NEAR(time.generic_at(time.moments()[i]), static_cast<double>(i), 1e-9);
      }
    }
  }
}

TEST(BlendTime, GenericTimeIsTheInverse) {
  const WeightCurve falling = {{0, 3}, {1, 0}}, rising = {{0, 3}, {0, 1}};
  for (const BlendTime& time :
       {blend_of(WeightCurve::constant(0.4), WeightCurve::constant(0.6)),
        blend_of(WeightCurve::constant(0.4), WeightCurve::constant(0.6), Warp::linear),
        blend_of(falling, rising), blend_of(falling, rising, Warp::linear)}) {
    for (int i = 0; i <= 500; ++i) {
      const double seconds = time.duration() * i / 500;
      EXPECT_NEAR(time.time_at(time.generic_at(seconds)), seconds, 1e-9) << i;
    }
    EXPECT_EQ(time.generic_at(-1), 0);
    EXPECT_EQ(time.generic_at(99), 3);
    EXPECT_EQ(time.generic_at(std::numeric_limits<double>::quiet_NaN()), 0);
  }
}

// For linear maps the integral is known: in the interval i the weight falls from 1 - i / 3 to
// 1 - (i + 1) / 3, so that each motion's part lasts by the mean of both.
TEST(BlendTime, ChangingWeightsIntegrate) {
  const BlendTime time = blend_of({{0, 3}, {1, 0}}, {{0, 3}, {0, 1}}, Warp::linear);
  double expected = 0;
  for (std::size_t i = 1; i < kSlow.size(); ++i) {
    const double slow = 1 - (static_cast<double>(i) - 0.5) / 3;
    expected += slow * (kSlow[i] - kSlow[i - 1]) + (1 - slow) * (kQuick[i] - kQuick[i - 1]);
    EXPECT_NEAR(time.moments()[i], expected, 1e-12) << i;
  }
}

TEST(BlendTime, RefusesWhatCannotBe) {
  const auto code = [](double slow, double quick, double shortest) {
    const auto time =
        BlendTime::create({TimeMap(kSlow, Warp::pchip), TimeMap(kQuick, Warp::pchip)},
                          {WeightCurve::constant(slow), WeightCurve::constant(quick)}, shortest);
    return time.ok() ? "" : time.error().code;
  };
  EXPECT_EQ(code(0.5, 0.5, 0.3), "");
  EXPECT_EQ(code(0, 1, 0.3), "blend-interval");       // 0.2 s
  EXPECT_EQ(code(-1, 2, 0.01), "blend-interval");     // 2 * 0.2 - 0.6 is negative
  EXPECT_EQ(code(0.5, -0.5, 0.01), "blend-weights");  // nothing
  EXPECT_EQ(code(std::nan(""), 1, 0.01), "blend-weights");
  // Only in the middle.
  const auto turned = BlendTime::create({TimeMap(kSlow, Warp::pchip), TimeMap(kQuick, Warp::pchip)},
                                        {{{0, 1, 3}, {0, -1, 0}}, {{0, 1, 3}, {1, 2, 1}}}, 0.01);
  ASSERT_FALSE(turned.ok());
  EXPECT_EQ(turned.error().code, "blend-interval");
}

TEST(WeightCurve, StraightBetweenPoints) {
  const WeightCurve curve = {{0, 1, 3}, {1, 0.5, 2}};
  EXPECT_EQ(curve.at(-1), 1);
  EXPECT_DOUBLE_EQ(curve.at(0.5), 0.75);
  EXPECT_DOUBLE_EQ(curve.at(2), 1.25);
  EXPECT_EQ(curve.at(7), 2);
  EXPECT_EQ(WeightCurve::constant(0.3).at(5), 0.3);
}

}  // namespace
}  // namespace krok::blend
