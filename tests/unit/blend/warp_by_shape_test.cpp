// If these fail, motions without keytimes are brought into step at the wrong moments.

#include "blend/warp_by_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/sample.h"
#include "unit/blend/blended_walks.h"

namespace krok::blend {
namespace {

// The clip played by another clock: at time t of the result it is clock(t) in the original.
template <typename Clock>
Clip played(const Clip& clip, double duration, const Clock& clock) {
  Clip result = clip;
  const int frames = static_cast<int>(std::floor(duration * clip.rate)) + 1;
  result.resize(frames);
  std::vector<Transform> pose(clip.skeleton.names.size()), scratch(3 * pose.size());
  for (int f = 0; f < frames; ++f) {
    sample(clip, clock(f / clip.rate), pose, scratch);
    result.set_pose(f, pose);
  }
  return result;
}

TEST(WarpByShape, FindsAKnownClock) {
  const KeyedWalk walk = keyed_walk(quick_walk());
  const double duration = walk.clip.duration();
  // Slower at first, quicker at last, by up to a third.
  const auto clock = [&](double t) {
    return t - 0.05 * duration * std::sin(2 * kPi * t / duration);
  };
  const Clip other = played(walk.clip, duration, clock);
  const std::vector<const Clip*> clips = {&walk.clip, &other};
  const auto found = warp_by_shape(clips, find_roles(walk.clip.skeleton));
  ASSERT_TRUE(found.ok());
  ASSERT_TRUE(check(*found).ok());
  EXPECT_GE(found->moments(), 8);
  double worst = 0, without = 0;
  for (std::size_t k = 0; k < found->names.size(); ++k) {
    worst = std::max(worst, std::abs(clock(found->times[1][k]) - found->times[0][k]));
    without = std::max(without, std::abs(clock(found->times[0][k]) - found->times[0][k]));
  }
  std::printf("worst %.0f ms, without a warp %.0f ms\n", 1e3 * worst, 1e3 * without);
  EXPECT_LT(worst, 0.04);
  EXPECT_GT(without, 3 * worst);
}

TEST(WarpByShape, OfAMotionWithItselfIsEven) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  const std::vector<const Clip*> clips = {&walk.clip, &walk.clip, &walk.clip};
  const auto found = warp_by_shape(clips, find_roles(walk.clip.skeleton));
  ASSERT_TRUE(found.ok());
  for (std::size_t k = 0; k < found->names.size(); ++k) {
    EXPECT_NEAR(found->times[1][k], found->times[0][k], 1e-9);
    EXPECT_NEAR(found->times[2][k], found->times[0][k], 1e-9);
  }
  EXPECT_EQ(found->names.front(), "begin");
  EXPECT_EQ(found->names.back(), "end");
}

TEST(WarpByShape, ShortAndLongMotions) {
  const KeyedWalk walk = keyed_walk(slow_walk());
  Clip two = walk.clip;
  two.resize(2);
  const RoleMap roles = find_roles(walk.clip.skeleton);
  const std::vector<const Clip*> clips = {&walk.clip, &two};
  const auto found = warp_by_shape(clips, roles);
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(check(*found).ok());
  two.resize(1);
  EXPECT_EQ(warp_by_shape(clips, roles).error().code, "blend-duration");
  Clip slow = walk.clip;
  slow.rate = 1e-3;  // hours
  const std::vector<const Clip*> uneven = {&walk.clip, &slow};
  EXPECT_TRUE(warp_by_shape(uneven, roles).ok());
}

}  // namespace
}  // namespace krok::blend
