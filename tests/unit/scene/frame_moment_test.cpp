// If these fail, sampling a clip shows a neighbouring frame, or a mixture where a frame stands.
#include "scene/clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace krok {
namespace {

TEST(FrameMoment, IsAFrameAtItsOwnTime) {
  for (const double rate : {30.0, 59.94, 1e-3, 12345.678}) {
    for (int f = 0; f < 3000; f += 7) {
      const FrameMoment moment = frame_moment(f / rate, rate, 3001);
      EXPECT_EQ(moment.before, f);
      EXPECT_EQ(moment.fraction, 0);
    }
  }
}

TEST(FrameMoment, IsThePartOfTheWayBetween) {
  const FrameMoment moment = frame_moment(0.35, 10, 9);
  EXPECT_EQ(moment.before, 3);
  EXPECT_NEAR(moment.fraction, 0.5, 1e-12);
}

TEST(FrameMoment, HoldsTheEnds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double time : {-1.0, -kInfinity, std::nan("")}) {
    EXPECT_EQ(frame_moment(time, 10, 4).before, 0);
    EXPECT_EQ(frame_moment(time, 10, 4).fraction, 0);
  }
  for (const double time : {0.3, 5.0, 1e300, kInfinity}) {
    EXPECT_EQ(frame_moment(time, 10, 4).before, 3);
    EXPECT_EQ(frame_moment(time, 10, 4).fraction, 0);
  }
  EXPECT_EQ(frame_moment(3, 10, 1).before, 0);
}

TEST(FramesWithin, CountsThoseThatFit) {
  EXPECT_EQ(frames_within(1, 30, 5).value(), 31);
  EXPECT_EQ(frames_within(0.99, 30, 5).value(), 30);
  EXPECT_EQ(frames_within(59 / 59.94, 59.94, 5).value(), 60);
  EXPECT_EQ(frames_within(0, 30, 5).value(), 1);
}

TEST(FramesWithin, RefusesRatesAndLengthsThatMakeNoClip) {
  for (const double rate : {0.0, -30.0, std::nan(""), std::numeric_limits<double>::infinity(),
                            1e300, 1.001e5, 0.000999, 1e-17, 1e-158, 5e-324}) {
    EXPECT_EQ(frames_within(1, rate, 5).error().code, "clip-rate") << rate;
  }
  EXPECT_EQ(frames_within(1e6, 1e3, 5).error().code, "clip-too-long");
  EXPECT_EQ(frames_within(1e300, 1e5, 0).error().code, "clip-too-long");
  EXPECT_EQ(frames_within(std::nan(""), 30, 5).error().code, "clip-too-long");
}

}  // namespace
}  // namespace krok
