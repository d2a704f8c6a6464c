// If these fail, a looped motion jumps, stumbles, slides sideways or walks in a circle when it
// repeats, or lasts a frame too long.

#include "motion/loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "samples/generator/walk.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

// A cycle of two steps takes exactly 60 frames.
Clip walk(double turn = 0, double rise = 0) {
  samples::WalkOptions options;
  options.steps = 8;
  options.cadence = 120;
  options.turn = turn;
  options.rise = rise;
  if (rise > 0) {
    options.step_length = 0.3;
    options.ground = samples::Ground::stairs;
  }
  return samples::make_walk(options).value().clip;
}

int carrier_of(const Clip& clip) {
  return carrying_joint(find_roles(clip.skeleton));
}

Looped looped(const Clip& clip, const LoopOptions& options = {}) {
  auto result = loop(clip, carrier_of(clip), options);
  EXPECT_TRUE(result.ok());
  return std::move(*result);
}

std::vector<int> all_joints(const Clip& clip) {
  std::vector<int> joints;
  for (int j = 0; j < clip.joint_count(); ++j) joints.push_back(j);
  return joints;
}

// The last frame is the first one moved by the displacement.
void expect_closed(const Looped& result) {
  const Clip& clip = result.clip;
  const int last = clip.frame_count() - 1;
  std::vector<Transform> first(clip.skeleton.names.size()), end(first.size());
  clip.get_pose(0, first);
  clip.get_pose(last, end);
  for (std::size_t j = 0; j < first.size(); ++j) {
    const Transform expected = result.displacement * first[j];
    EXPECT_LT((expected.position - end[j].position).norm(), 2e-6);
    EXPECT_LT(angle_between(expected.orientation, end[j].orientation), 1e-6);
  }
  EXPECT_TRUE(check(clip).ok());
}

// The largest second difference of any joint's place, metres a frame squared: what a jump of
// velocity shows in.
double roughness(const Clip& clip, int first, int last) {
  double most = 0;
  for (int f = std::max(1, first); f <= last && f + 1 < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      const Vec3f bend = clip.frame_positions(f - 1)[at] - 2 * clip.frame_positions(f)[at] +
                         clip.frame_positions(f + 1)[at];
      most = std::max<double>(most, bend.norm());
    }
  }
  return most;
}

TEST(Loop, AMotionThatRepeatsAlreadyStaysAsItIs) {
  for (const int begin : {5, 20, 50}) {
    const Clip cycle = cut(walk(), begin, begin + 60);
    const Looped result = looped(cycle);
    EXPECT_EQ(result.added_frames, 0);
    ASSERT_EQ(result.clip.frame_count(), 61);
    EXPECT_LT(largest_displacement(cycle, result.clip, all_joints(cycle)).distance, 1e-3) << begin;
    EXPECT_NEAR(result.displacement.position.z(), 1.4, 1e-3);
    EXPECT_NEAR(result.displacement.position.x(), 0, 1e-3);
    EXPECT_EQ(result.displacement.position.y(), 0);
    expect_closed(result);
  }
}

TEST(Loop, AddsTheClosingFrameWhereItIsMissing) {
  const Clip whole = walk();
  const Looped result = looped(cut(whole, 20, 79));
  EXPECT_EQ(result.added_frames, 1);
  ASSERT_EQ(result.clip.frame_count(), 61);
  EXPECT_NEAR(result.clip.duration(), 1.0, 1e-9);
  // It is the frame that was cut off.
  EXPECT_LT(largest_displacement(cut(whole, 20, 80), result.clip, all_joints(whole)).distance,
            4e-3);
  expect_closed(result);
  LoopOptions closed;
  closed.end = LoopEnd::closed;
  EXPECT_EQ(looped(cut(whole, 20, 79), closed).clip.frame_count(), 60);
  LoopOptions open;
  open.end = LoopEnd::open;
  EXPECT_EQ(looped(cut(whole, 20, 80), open).clip.frame_count(), 62);
}

TEST(Loop, APoorCutIsBlended) {
  const Clip poor = cut(walk(), 10, 73);
  const Looped result = looped(poor);
  EXPECT_EQ(result.clip.frame_count(), poor.frame_count());
  EXPECT_GT(result.before.angle, 5 * kRadiansPerDegree);
  EXPECT_LT(result.after.angle, 1e-9);
  EXPECT_LT(result.after.distance, 1e-9);
  expect_closed(result);
  // Frames away from the seam are untouched, the way straightened apart.
  EXPECT_EQ(result.blended_frames, 12);
  LoopOptions keep;
  keep.turn = LoopTurn::keep;
  keep.end = LoopEnd::closed;
  const Looped same = looped(poor, keep);
  EXPECT_LT(
      largest_displacement(cut(poor, 12, 51), cut(same.clip, 12, 51), all_joints(poor)).distance,
      1e-6);
  // Played three times, the seams are no rougher than the walk is elsewhere.
  const auto played = repeated(same.clip, same.displacement, 3);
  ASSERT_TRUE(played.ok());
  ASSERT_EQ(played->frame_count(), 3 * 63 + 1);
  EXPECT_LT(roughness(*played, 60, 66), 1.5 * roughness(walk(), 1, 239));
  Clip cut_hard = poor;
  const auto hard = repeated(cut_hard, same.displacement, 3);
  EXPECT_GT(roughness(*hard, 60, 66), 3 * roughness(walk(), 1, 239));
}

TEST(Loop, ATurningWalkKeepsItsTurnAndADriftIsStraightened) {
  const Clip turning = walk(15 * kRadiansPerDegree);
  const Looped kept = looped(cut(turning, 20, 80));
  EXPECT_NEAR(kept.turn, 30 * kRadiansPerDegree, 1 * kRadiansPerDegree);
  EXPECT_EQ(kept.straightened, 0);
  expect_closed(kept);

  const Clip drifting = cut(walk(2 * kRadiansPerDegree), 20, 80);
  const Looped straight = looped(drifting);
  EXPECT_EQ(straight.turn, 0);
  EXPECT_NEAR(straight.straightened, 4 * kRadiansPerDegree, 0.5 * kRadiansPerDegree);
  EXPECT_LT(std::abs(straight.displacement.orientation.y()), 1e-12);
  expect_closed(straight);
  // Its length is kept.
  EXPECT_NEAR(straight.displacement.position.norm(),
              looped(drifting, {.turn = LoopTurn::keep}).displacement.position.norm(), 0.01);
  const Looped forced = looped(cut(turning, 20, 80), {.turn = LoopTurn::straighten});
  EXPECT_EQ(forced.turn, 0);
  expect_closed(forced);
}

// Would fail if feet slid while an engine moves and turns a straightened loop, as they do where the
// body's sway about its arc is not taken with it.
TEST(Loop, AStraightenedLoopTurnedAgainIsTheLoopBefore) {
  const Clip turning = walk(15 * kRadiansPerDegree);
  const Looped kept = looped(cut(turning, 20, 80));
  const double length = kept.clip.duration();
  Looped straight = kept;
  straighten(carrier_of(turning), straight);
  EXPECT_EQ(straight.turn, 0);
  EXPECT_EQ(straight.straightened, kept.turn);
  expect_closed(straight);
  const RootMotion removed{straight.displacement.position / length, kept.turn / length};
  const Clip standing = in_place(straight.clip, carrier_of(turning), Travel::trend);
  const Clip again = carried_along(standing, carrier_of(turning), removed);
  for (int f = 0; f < again.frame_count(); ++f) {
    for (int j = 0; j < again.joint_count(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      EXPECT_LT((again.frame_positions(f)[at] - kept.clip.frame_positions(f)[at]).norm(), 5e-6f);
    }
  }
}

TEST(Loop, StairsClimbAndUnevenHeightsAreLevelled) {
  const Clip stairs = walk(0, 0.16);
  const Looped up = looped(cut(stairs, 20, 80));
  EXPECT_NEAR(up.displacement.position.y(), 0.32, 0.01);
  EXPECT_EQ(up.levelled, 0);
  expect_closed(up);
  Clip sinking = cut(walk(), 20, 80);
  for (int f = 0; f <= 60; ++f) {
    for (Vec3f& p : sinking.frame_positions(f)) p.y() -= 0.0003f * static_cast<float>(f);
  }
  const Looped level = looped(sinking);
  EXPECT_EQ(level.displacement.position.y(), 0);
  EXPECT_NEAR(level.levelled, -0.018, 1e-3);
  expect_closed(level);
}

// Hips that travel below a root that only places the figure.
TEST(Loop, AStillRootTravelsAlongAfterwards) {
  const Clip plain = cut(walk(), 20, 83);
  Clip rooted;
  rooted.rate = plain.rate;
  rooted.skeleton.add("Root", -1, {});
  for (int j = 0; j < plain.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    rooted.skeleton.add(plain.skeleton.names[at], plain.skeleton.parents[at] + 1,
                        plain.skeleton.reference[at], plain.skeleton.end_sites[at] != 0);
  }
  rooted.resize(plain.frame_count());
  std::vector<Transform> pose(plain.skeleton.names.size() + 1);
  for (int f = 0; f < plain.frame_count(); ++f) {
    plain.get_pose(f, std::span(pose).subspan(1));
    rooted.set_pose(f, pose);
  }
  ASSERT_EQ(carrier_of(rooted), 1);
  const Looped result = looped(rooted);
  EXPECT_TRUE(result.carried);
  expect_closed(result);
  // The figure itself does as it does without the root.
  const Looped reference = looped(plain);
  EXPECT_LT((result.displacement.position - reference.displacement.position).norm(), 1e-5);
  for (const int f : {0, 30, 63}) {
    EXPECT_LT((result.clip.frame_positions(f)[7] - reference.clip.frame_positions(f)[6]).norm(),
              2e-2f);
  }
}

TEST(Loop, WhereTheActorStandsAndFacesDoesNotMatter) {
  const Clip clip = cut(walk(3 * kRadiansPerDegree), 10, 72);
  const Transform move{Vec3(3, 0, -7), from_rotation_vector(Vec3(0, 2.2, 0))};
  Clip moved = clip;
  move_clip(move, moved);
  Clip expected = looped(clip).clip;
  move_clip(move, expected);
  EXPECT_LT(largest_displacement(looped(moved).clip, expected, all_joints(clip)).distance, 2e-5);
}

TEST(Loop, ShortClipsOneJointAndNonsense) {
  Skeleton single;
  single.add("root", -1, {});
  for (const Skeleton& skeleton : {test::human_skeleton(), single}) {
    for (const int frames : {0, 1, 2, 3}) {
      const Clip clip = test::swinging_clip(skeleton, frames, 30);
      const auto result = loop(clip, 0, {});
      ASSERT_FALSE(result.ok());
      EXPECT_EQ(result.error().code, "motion-loop");
    }
    for (const int frames : {4, 5, 6, 7}) {
      expect_closed(looped(test::swinging_clip(skeleton, frames, 30)));
    }
  }
  const Clip clip = test::swinging_clip(single, 10, 30);
  EXPECT_EQ(loop(clip, 0, {.blend = -1}).error().code, "motion-blend");
  EXPECT_EQ(loop(clip, 0, {.blend = NAN}).error().code, "motion-blend");
  expect_closed(looped(clip, {.blend = 0}));
  expect_closed(looped(clip, {.blend = 1e9}));
}

TEST(Repeated, GoesOnRoundAfterRound) {
  const Looped result = looped(cut(walk(15 * kRadiansPerDegree), 20, 80));
  const auto played = repeated(result.clip, result.displacement, 12);
  ASSERT_TRUE(played.ok());
  EXPECT_EQ(played->frame_count(), 12 * 60 + 1);
  // Twelve times thirty degrees is a whole circle.
  EXPECT_NEAR(wrapped(ground_frame(*played, 0, 720).heading - ground_frame(*played, 0, 0).heading),
              0, 15 * kRadiansPerDegree);
  EXPECT_EQ(repeated(result.clip, result.displacement, 1)->frame_count(), 61);
  EXPECT_EQ(repeated(result.clip, result.displacement, 2'000'000'000).error().code,
            "clip-too-long");
}

}  // namespace
}  // namespace krok
