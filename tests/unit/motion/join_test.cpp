// If these fail, one motion after another jumps where they meet, or motions of different figures
// are mixed up.

#include "motion/join.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "roles/roles.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"
#include "unit/motion/joint_place.h"

namespace krok {
namespace {

using test::joint_place;
using test::swinging_human;

TEST(Join, CutInTwoAndJoinedAgainItIsTheSame) {
  const Clip whole = swinging_human(61);
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
        EXPECT_LT((joint_place(joined->clip, f, j) - joint_place(whole, f, j)).norm(), 1e-5) << f;
      }
    }
  }
}

TEST(Join, GoesOnWhereTheFirstStandsAndFaces) {
  Clip second = swinging_human(31);
  move_clip({Vec3(-3, 0, 9), from_rotation_vector(Vec3(0, 1.1, 0))}, second);
  const auto joined = join(swinging_human(31), second, 0, {.blend = 0});
  ASSERT_TRUE(joined.ok());
  EXPECT_EQ(joined->clip.frame_count(), 61);
  EXPECT_EQ(joined->joint_frame, 30);
  const GroundFrame end = ground_frame(swinging_human(31), 0, 30);
  const GroundFrame at = ground_frame(joined->clip, 0, 30);
  EXPECT_NEAR(at.x, end.x, 1e-5);
  EXPECT_NEAR(at.z, end.z, 1e-5);
  // Its next step leads on from there as the second's first did.
  const Vec3 step =
      second.frame_positions(1)[0].cast<double>() - second.frame_positions(0)[0].cast<double>();
  const Vec3 made = joined->clip.frame_positions(31)[0].cast<double>() -
                    joined->clip.frame_positions(30)[0].cast<double>();
  EXPECT_NEAR(Vec2(made.x(), made.z()).norm(), Vec2(step.x(), step.z()).norm(), 1e-5);
  EXPECT_NEAR(joint_place(joined->clip, 31, 0).y(), joint_place(second, 1, 0).y(), 1e-6);
}

// Hips and chest that turn against each other with each step.
Clip straight_walk() {
  Clip walk;
  walk.skeleton = test::human_skeleton();
  walk.rate = 60;
  walk.resize(240);
  const auto joint = [&](const char* name) {
    return static_cast<std::size_t>(walk.skeleton.find(name));
  };
  std::vector<Transform> local, world(walk.skeleton.names.size());
  for (int j = 0; j < walk.skeleton.joint_count(); ++j) {
    local.push_back(walk.skeleton.reference_local(j));
  }
  for (int f = 0; f < walk.frame_count(); ++f) {
    const double time = f / walk.rate, swing = std::sin(2 * kPi * time / 1.1);
    local[0].position.z() = 1.3 * time;
    local[0].orientation = axis_rotation(Axis::y, 0.17 * swing);
    local[joint("Spine")].orientation = axis_rotation(Axis::y, -0.25 * swing);
    local[joint("LeftUpLeg")].orientation = axis_rotation(Axis::x, 0.4 * swing);
    local[joint("RightUpLeg")].orientation = axis_rotation(Axis::x, -0.4 * swing);
    local_to_world(walk.skeleton.parents, local, world);
    walk.set_pose(f, world);
  }
  return walk;
}

// Would fail if the hips' turn in one frame, in the middle of a step, became a turn of the way.
TEST(Join, WhoWalksStraightGoesOnStraight) {
  const Clip walk = straight_walk();
  const int chest = walk.skeleton.find("Spine2");
  for (const int from : {20, 50, 66, 90}) {
    const auto joined =
        join(cut(walk, 0, 148), cut(walk, from, 239), 0, {.blend = 0.2, .chest = chest});
    ASSERT_TRUE(joined.ok());
    const Vec3 way = joint_place(joined->clip, joined->clip.frame_count() - 1, 0) -
                     joint_place(joined->clip, joined->joint_frame + 10, 0);
    EXPECT_NEAR(std::atan2(way.x(), way.z()), 0, 0.04) << from;
  }
}

// A reference pose whose chest is half round against its hips, as in ACCAD's files. Would fail if
// the difference between both, now half round to the left and now to the right, told how one faces:
// who walks would go on backwards.
TEST(Join, AChestTwistedInTheReferencePoseTurnsNobody) {
  Clip walk = straight_walk();
  const int chest = walk.skeleton.find("Spine2");
  ASSERT_GE(chest, 0);
  const std::vector<std::uint8_t> above = subtree(walk.skeleton, chest);
  for (std::size_t j = 0; j < above.size(); ++j) {
    if (above[j] == 0) continue;
    Quat& turned = walk.skeleton.reference[j].orientation;
    turned = from_rotation_vector(Vec3(0, kPi, 0)) * turned;
  }
  for (int from = 0; from <= 120; from += 15) {
    const auto joined =
        join(walk, cut(walk, from, walk.frame_count() - 1), 0, {.blend = 0.2, .chest = chest});
    ASSERT_TRUE(joined.ok());
    for (int f = 0; f < joined->clip.frame_count(); ++f) {
      EXPECT_LT(std::abs(ground_frame(joined->clip, 0, f).heading), 30 * kRadiansPerDegree) << f;
    }
  }
}

TEST(Join, OtherRatesBecomeTheFirsts) {
  const auto fast = retime(swinging_human(31), 120, 1, LastFrame::within);
  const auto joined = join(swinging_human(31), *fast, 0, {.blend = 0.1});
  ASSERT_TRUE(joined.ok());
  EXPECT_EQ(joined->clip.rate, 30);
  EXPECT_EQ(joined->clip.frame_count(), 31 + 31 - 1 - 3);
}

TEST(Join, HeightsAreKeptOrMatched) {
  Clip second = swinging_human(31);
  move_clip({Vec3(0, -2, 0), Quat::Identity()}, second);
  const auto kept = join(swinging_human(31), second, 0, {.blend = 0});
  EXPECT_NEAR(joint_place(kept->clip, 60, 0).y(), joint_place(second, 30, 0).y(), 1e-5);
  const auto matched = join(swinging_human(31), second, 0, {.blend = 0, .match_height = true});
  EXPECT_NEAR(joint_place(matched->clip, 31, 0).y(), joint_place(swinging_human(31), 30, 0).y(),
              0.05);
}

TEST(Join, BlendsWithoutStretchingBones) {
  const Clip first = swinging_human(61);
  const auto joined = join(first, cut(swinging_human(91), 40, 90), 0, {.blend = 0.4});
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
  EXPECT_EQ(join(swinging_human(31), swinging_human(0), 0, {})->clip.positions,
            swinging_human(31).positions);
  EXPECT_EQ(join(swinging_human(0), swinging_human(31), 0, {})->clip.positions,
            swinging_human(31).positions);
  EXPECT_EQ(join(swinging_human(1), swinging_human(1), 0, {.blend = 0})->clip.frame_count(), 1);
}

// Would fail if what a frame becomes depended on the frames that are read with it.
TEST(Join, ReadInPartsItIsTheSame) {
  Skeleton below_a_root;
  below_a_root.add("Root", -1, {});
  const Skeleton human = test::human_skeleton();
  for (std::size_t j = 0; j < human.names.size(); ++j) {
    below_a_root.add(human.names[j], human.parents[j] + 1, human.reference[j]);
  }
  for (const Skeleton& skeleton : {human, below_a_root}) {
    const RoleMap roles = find_roles(skeleton);
    const int carrier = carrying_joint(roles);
    const Clip first = test::swinging_clip(skeleton, 61, 30);
    const Clip second = test::swinging_clip(skeleton, 101, 50);
    const JoinOptions options{0.4, false, roles.joint(Role::chest)};
    const auto whole = join(first, second, carrier, options);
    ASSERT_TRUE(whole.ok()) << whole.error().message;
    const auto made = join(frames_of(first), frames_of(second), carrier, options, 2);
    ASSERT_TRUE(made.ok());
    EXPECT_EQ(made->largest_joint, whole->largest_joint);
    const auto joints = static_cast<std::size_t>(first.joint_count());
    ASSERT_EQ(made->frames.frame_count, whole->clip.frame_count());
    for (const int count : {1, 7}) {
      for (int f = 0; f + count <= whole->clip.frame_count(); f += count) {
        std::vector<Vec3f> places(joints * static_cast<std::size_t>(count));
        std::vector<Quatf> turns(places.size());
        ASSERT_TRUE(made->frames.read(f, count, places, turns).ok());
        EXPECT_TRUE(std::ranges::equal(
            places, std::span(whole->clip.positions).subspan(at(f) * joints, places.size())))
            << f;
      }
    }
  }
}

TEST(Join, OtherSkeletonsAreRefused) {
  const auto refused = [](const Clip& a, const Clip& b) {
    const auto result = join(a, b, 0, {});
    EXPECT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "motion-skeleton");
    EXPECT_NE(result.error().hint.find("krok-retarget"), std::string::npos);
    return result.error().message;
  };
  Clip other = swinging_human(61);
  other.skeleton.names[3] = "Chest";
  EXPECT_NE(refused(swinging_human(61), other).find("Chest"), std::string::npos);
  const std::string longer =
      refused(swinging_human(61), test::swinging_clip(test::human_skeleton(2.0), 61, 30));
  EXPECT_NE(longer.find("m long"), std::string::npos) << longer;
  refused(swinging_human(61),
          test::swinging_clip(test::with_turned_joints(test::human_skeleton()), 61, 30));
}

TEST(Join, ABlendThatDoesNotFitIsRefused) {
  for (const double blend : {-0.1, 2.1, 1e300, double(NAN)}) {
    const auto result = join(swinging_human(61), swinging_human(31), 0, {.blend = blend});
    ASSERT_FALSE(result.ok()) << blend;
    EXPECT_EQ(result.error().code, "motion-blend");
  }
  EXPECT_TRUE(join(swinging_human(61), swinging_human(31), 0, {.blend = 1.0}).ok());
}

}  // namespace
}  // namespace krok
