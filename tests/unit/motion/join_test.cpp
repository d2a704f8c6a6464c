// If these fail, one motion after another jumps where they meet, or motions of different figures
// are mixed up.

#include "motion/join.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "motion/cut.h"
#include "motion/ground_place.h"
#include "motion/local_motion.h"
#include "motion/place.h"
#include "motion/retime.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

Clip motion(int frames = 61, double rate = 30) {
  return test::swinging_clip(test::human_skeleton(), frames, rate);
}

Vec3f place(const Clip& clip, int frame, int joint) {
  return clip.frame_positions(frame)[static_cast<std::size_t>(joint)];
}

TEST(Join, CutInTwoAndJoinedAgainItIsTheSame) {
  const Clip whole = motion();
  for (const double blend : {0.0, 0.2, 0.5}) {
    const int shared = static_cast<int>(std::lround(blend * 30));
    Clip second = cut(whole, 30 - shared, 60);
    move_clip({Vec3(4, 0, 1), from_rotation_vector(Vec3(0, -2, 0))}, second);
    const auto joined = join(cut(whole, 0, 30), second, 0, {.blend = blend});
    ASSERT_TRUE(joined.ok());
    ASSERT_EQ(joined->clip.frame_count(), 61) << blend;
    EXPECT_EQ(joined->shared_frames, shared + 1);
    EXPECT_LT(joined->largest_angle, 1e-5);
    for (int f = 0; f <= 60; ++f) {
      for (const int j : {0, 6, 12}) {
        EXPECT_LT((place(joined->clip, f, j) - place(whole, f, j)).norm(), 1e-5f) << f;
      }
    }
  }
}

TEST(Join, GoesOnWhereTheFirstStandsAndFaces) {
  Clip second = motion(31);
  move_clip({Vec3(-3, 0, 9), from_rotation_vector(Vec3(0, 1.1, 0))}, second);
  const auto joined = join(motion(31), second, 0, {.blend = 0});
  ASSERT_TRUE(joined.ok());
  EXPECT_EQ(joined->clip.frame_count(), 61);
  EXPECT_EQ(joined->joint_frame, 30);
  const GroundPlace end = ground_place(motion(31), 0, 30);
  const GroundPlace at = ground_place(joined->clip, 0, 30);
  EXPECT_NEAR(at.x, end.x, 1e-5);
  EXPECT_NEAR(at.z, end.z, 1e-5);
  // Its next step leads on from there as the second's first did.
  const Vec3 step =
      second.frame_positions(1)[0].cast<double>() - second.frame_positions(0)[0].cast<double>();
  const Vec3 made = joined->clip.frame_positions(31)[0].cast<double>() -
                    joined->clip.frame_positions(30)[0].cast<double>();
  EXPECT_NEAR(Vec2(made.x(), made.z()).norm(), Vec2(step.x(), step.z()).norm(), 1e-5);
  EXPECT_NEAR(Vec3f(place(joined->clip, 31, 0)).y(), place(second, 1, 0).y(), 1e-6);
}

TEST(Join, OtherRatesBecomeTheFirsts) {
  const auto fast = retime(motion(31), 120, 1, LastFrame::within);
  const auto joined = join(motion(31), *fast, 0, {.blend = 0.1});
  ASSERT_TRUE(joined.ok());
  EXPECT_EQ(joined->clip.rate, 30);
  EXPECT_EQ(joined->clip.frame_count(), 31 + 31 - 1 - 3);
}

TEST(Join, HeightsAreKeptOrMatched) {
  Clip second = motion(31);
  move_clip({Vec3(0, -2, 0), Quat::Identity()}, second);
  const auto kept = join(motion(31), second, 0, {.blend = 0});
  EXPECT_NEAR(place(kept->clip, 60, 0).y(), place(second, 30, 0).y(), 1e-5);
  const auto matched = join(motion(31), second, 0, {.blend = 0, .match_height = true});
  EXPECT_NEAR(place(matched->clip, 31, 0).y(), place(motion(31), 30, 0).y(), 0.05);
}

TEST(Join, BlendsWithoutStretchingBones) {
  const Clip first = motion(61);
  const auto joined = join(first, cut(motion(91), 40, 90), 0, {.blend = 0.4});
  ASSERT_TRUE(joined.ok());
  EXPECT_GT(joined->largest_angle, 0.1);
  const LocalMotion before = local_motion(first), after = local_motion(joined->clip);
  for (int j = 1; j < after.joints; ++j) {
    for (int f = 0; f < after.frames; ++f) {
      EXPECT_LT((after.at(j, f).position - before.at(j, 0).position).norm(), 1e-6);
    }
  }
}

TEST(Join, NothingToAddAndNothingToAddTo) {
  EXPECT_EQ(join(motion(31), motion(0), 0, {})->clip.positions, motion(31).positions);
  EXPECT_EQ(join(motion(0), motion(31), 0, {})->clip.positions, motion(31).positions);
  EXPECT_EQ(join(motion(1), motion(1), 0, {.blend = 0})->clip.frame_count(), 1);
}

TEST(Join, OtherSkeletonsAreRefused) {
  const auto refused = [](const Clip& a, const Clip& b) {
    const auto result = join(a, b, 0, {});
    EXPECT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "motion-skeleton");
    EXPECT_NE(result.error().hint.find("krok-retarget"), std::string::npos);
    return result.error().message;
  };
  Clip other = motion();
  other.skeleton.names[3] = "Chest";
  EXPECT_NE(refused(motion(), other).find("Chest"), std::string::npos);
  const std::string longer =
      refused(motion(), test::swinging_clip(test::human_skeleton(2.0), 61, 30));
  EXPECT_NE(longer.find("m long"), std::string::npos) << longer;
  refused(motion(), test::swinging_clip(test::with_turned_joints(test::human_skeleton()), 61, 30));
}

TEST(Join, ABlendThatDoesNotFitIsRefused) {
  for (const double blend : {-0.1, 2.1, 1e300, double(NAN)}) {
    const auto result = join(motion(61), motion(31), 0, {.blend = blend});
    ASSERT_FALSE(result.ok()) << blend;
    EXPECT_EQ(result.error().code, "motion-blend");
  }
  EXPECT_TRUE(join(motion(61), motion(31), 0, {.blend = 1.0}).ok());
}

}  // namespace
}  // namespace krok
