// Would fail if a part of a motion began or ended at another frame, or played at another speed.

#include "motion/sample.h"

#include <gtest/gtest.h>

#include "support/test_scenes.h"

namespace krok {
namespace {

TEST(Cut, TakesEveryNthFrameAndKeepsTheSpeed) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 11, 30);
  const Clip part = cut(clip, 2, 9, 3);
  ASSERT_EQ(part.frame_count(), 3);
  EXPECT_DOUBLE_EQ(part.rate, 10);
  EXPECT_DOUBLE_EQ(part.duration(), 0.2);
  for (int f = 0; f < 3; ++f) {
    EXPECT_EQ(part.frame_positions(f)[5], clip.frame_positions(2 + 3 * f)[5]);
    EXPECT_EQ(part.frame_orientations(f)[5].coeffs(),
              clip.frame_orientations(2 + 3 * f)[5].coeffs());
  }
  EXPECT_TRUE(check(part).ok());
}

TEST(Cut, AllOfItAndOneFrameOfIt) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 11, 30);
  EXPECT_EQ(cut(clip, 0, 10).positions, clip.positions);
  const Clip one = cut(clip, 10, 10);
  ASSERT_EQ(one.frame_count(), 1);
  EXPECT_EQ(one.frame_positions(0)[3], clip.frame_positions(10)[3]);
}

}  // namespace
}  // namespace krok
