// If these fail, what the samples lay over a walk is no gesture: it jumps, it does not come back to
// where it began, it moves feet that stand, or an elbow bends the wrong way.

#include "samples/generator/gesture.h"

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "samples/generator/walk.h"

namespace krok::samples {
namespace {

Clip made(Gesture kind, Side side = Side::right, double duration = 3) {
  auto clip = make_gesture({kind, side, 1.75, duration, 60});
  EXPECT_TRUE(clip.ok());
  return clip ? *clip : Clip();
}

Transform joint_at(const Clip& clip, int frame, int joint) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  return pose[static_cast<std::size_t>(joint)];
}

class EachGesture : public testing::TestWithParam<std::tuple<Gesture, Side>> {};
INSTANTIATE_TEST_SUITE_P(All, EachGesture,
                         testing::Combine(testing::Values(Gesture::wave, Gesture::limp,
                                                          Gesture::look),
                                          testing::Values(Side::left, Side::right)));

TEST_P(EachGesture, IsSoundAndBeginsAndEndsAtRest) {
  const auto [kind, side] = GetParam();
  const Clip clip = made(kind, side);
  ASSERT_TRUE(check(clip).ok());
  ASSERT_EQ(clip.frame_count(), 181);
  for (int j = 0; j < clip.joint_count(); ++j) {
    const Transform first = joint_at(clip, 0, j), last = joint_at(clip, 180, j);
    EXPECT_LT((first.position - last.position).norm(), 1e-6) << clip.skeleton.names[size_t(j)];
    EXPECT_LT(angle_between(first.orientation, last.orientation), 1e-5);
  }
}

TEST_P(EachGesture, LeavesHipsAndLegsAlone) {
  const auto [kind, side] = GetParam();
  const Clip clip = made(kind, side);
  const Actor actor = make_actor(1.75);
  for (const int joint : {actor.hips, actor.legs[0].foot, actor.legs[1].toes}) {
    for (int f = 1; f < clip.frame_count(); ++f) {
      ASSERT_LT((joint_at(clip, f, joint).position - joint_at(clip, 0, joint).position).norm(),
                1e-6);
    }
  }
}

// 720 degrees a second is a brisk wave of the hand; a jump would be more.
TEST_P(EachGesture, MovesWithoutJumps) {
  const auto [kind, side] = GetParam();
  const Clip clip = made(kind, side);
  for (int f = 1; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      ASSERT_LT(
          angle_between(joint_at(clip, f - 1, j).orientation, joint_at(clip, f, j).orientation),
          12 * kRadiansPerDegree)
          << clip.skeleton.names[size_t(j)] << " frame " << f;
    }
  }
}

TEST(Wave, LiftsTheHandOfItsSideAboveTheShoulderPalmForward) {
  for (const Side side : {Side::left, Side::right}) {
    const Clip clip = made(Gesture::wave, side);
    const Actor actor = make_actor(1.75);
    const ArmJoints& arm = actor.arms[size_t(side)];
    const ArmJoints& still = actor.arms[size_t(other(side))];
    double least = 10, most = -10;
    for (int f = 75; f <= 105; ++f) {
      const Transform hand = joint_at(clip, f, arm.hand);
      const Vec3 shoulder = joint_at(clip, f, arm.upper).position;
      EXPECT_GT(hand.position.y(), shoulder.y() + 0.1);
      EXPECT_GT(side_sign(side) * (hand.position.x() - shoulder.x()), 0.1);
      // In the reference pose palms face down.
      EXPECT_GT((hand.orientation * Vec3(0, -1, 0)).z(), 0.6);
      least = std::min(least, hand.position.x());
      most = std::max(most, hand.position.x());
      EXPECT_LT(joint_at(clip, f, still.hand).position.y(), shoulder.y());
    }
    EXPECT_GT(most - least, 0.1);
  }
}

TEST(Limp, LeansOverTheLegWhileItStandsAlone) {
  for (const Side side : {Side::left, Side::right}) {
    const Clip clip = made(Gesture::limp, side, 1.2);
    const Actor actor = make_actor(1.75);
    const double rest = joint_at(clip, 0, actor.head).position.x();
    const auto lean = [&](double phase) {
      const int frame = static_cast<int>(phase * (clip.frame_count() - 1));
      return side_sign(side) * (joint_at(clip, frame, actor.head).position.x() - rest);
    };
    EXPECT_GT(lean(0.31), 0.05);
    EXPECT_NEAR(lean(0.8), 0, 1e-6);
  }
}

TEST(Look, TurnsTheHeadToItsSide) {
  const Clip clip = made(Gesture::look, Side::left);
  const Actor actor = make_actor(1.75);
  const Vec3 ahead = joint_at(clip, 90, actor.head).orientation * Vec3(0, 0, 1);
  EXPECT_GT(ahead.x(), 0.7);
}

TEST(GestureOptions, OutsideTheirRangesAreRefused) {
  for (const GestureOptions& options :
       {GestureOptions{.stature = 3}, GestureOptions{.duration = 0.1}, GestureOptions{.rate = 0},
        GestureOptions{.duration = std::nan("")}}) {
    const auto clip = make_gesture(options);
    ASSERT_FALSE(clip.ok());
    EXPECT_EQ(clip.error().code, "gesture-option");
  }
}

}  // namespace
}  // namespace krok::samples
