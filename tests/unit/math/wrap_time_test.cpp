// If these fail, loops stumble at their seam or play the wrong way.
#include "tracks/sample_keys.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/special_values.h"

namespace krok {
namespace {

using test::kInfinity;

TEST(WrapTime, WithinTheDurationIsTheTimeItself) {
  for (const Wrap wrap : {Wrap::clamp, Wrap::loop, Wrap::ping_pong}) {
    for (const double time : {0.0, 0.3, 2.0}) EXPECT_EQ(wrap_time(time, 2, wrap), time);
  }
}

TEST(WrapTime, Clamps) {
  EXPECT_EQ(wrap_time(-1, 2, Wrap::clamp), 0);
  EXPECT_EQ(wrap_time(7, 2, Wrap::clamp), 2);
  EXPECT_EQ(wrap_time(kInfinity, 2, Wrap::clamp), 2);
  EXPECT_EQ(wrap_time(-kInfinity, 2, Wrap::clamp), 0);
}

TEST(WrapTime, Loops) {
  for (int round = -3; round <= 3; ++round) {
    EXPECT_NEAR(wrap_time(0.5 + 2 * round, 2, Wrap::loop), 0.5, 1e-14) << round;
  }
  EXPECT_EQ(wrap_time(4, 2, Wrap::loop), 0);
  // So little before the beginning that the sum would round to the end.
  EXPECT_EQ(wrap_time(-1e-300, 2, Wrap::loop), 0);
}

TEST(WrapTime, GoesThereAndBack) {
  EXPECT_NEAR(wrap_time(2.5, 2, Wrap::ping_pong), 1.5, 1e-14);
  EXPECT_NEAR(wrap_time(4.5, 2, Wrap::ping_pong), 0.5, 1e-14);
  EXPECT_NEAR(wrap_time(-0.5, 2, Wrap::ping_pong), 0.5, 1e-14);
  EXPECT_NEAR(wrap_time(-3.5, 2, Wrap::ping_pong), 0.5, 1e-14);
  for (double t = -9; t < 9; t += 0.01) {
    const double step =
        std::abs(wrap_time(t + 0.01, 2, Wrap::ping_pong) - wrap_time(t, 2, Wrap::ping_pong));
    EXPECT_LE(step, 0.01 + 1e-12) << t;
  }
}

TEST(WrapTime, OfNothingIsZero) {
  for (const Wrap wrap : {Wrap::clamp, Wrap::loop, Wrap::ping_pong}) {
    for (const double duration : {0.0, -1.0, std::nan(""), kInfinity}) {
      EXPECT_EQ(wrap_time(3, duration, wrap), 0);
    }
    EXPECT_EQ(wrap_time(std::nan(""), 2, wrap), 0);
  }
  EXPECT_EQ(wrap_time(kInfinity, 2, Wrap::loop), 0);
  EXPECT_EQ(wrap_time(-kInfinity, 2, Wrap::ping_pong), 0);
}

}  // namespace
}  // namespace krok
