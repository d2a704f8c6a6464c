// If these fail, a motion begins elsewhere, faces another way, floats, has another size or pace
// than was asked for.

#include "motion/travel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/joint_selection.h"
#include "motion/sample.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

using test::swinging_human;

// The motion with the figure led astray first.
Clip astray() {
  Clip clip = swinging_human(31);
  move_clip({Vec3(3, 0.4, -2), from_rotation_vector(Vec3(0, 2.5, 0))}, clip);
  return clip;
}

double distance(const Clip& a, const Clip& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    most = std::max<double>(most, (a.positions[i] - b.positions[i]).norm());
  }
  return most;
}

TEST(GroundFrame, TellsHeadingsLeaningOrNot) {
  const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  for (const double heading : {0.0, 0.5, -2.0, 3.1}) {
    for (const Vec3& lean : {Vec3(0, 0, 0), Vec3(1.2, 0, 0), Vec3(-1.5, 0, 0)}) {
      Transform hips = skeleton.reference[0];
      hips.orientation =
          from_rotation_vector(Vec3(0, heading, 0)) * from_rotation_vector(lean) * hips.orientation;
      EXPECT_NEAR(ground_frame(skeleton, 0, hips).heading, heading, 1e-12);
    }
  }
  Transform upside_down = skeleton.reference[0];
  upside_down.orientation = Quat(0, 1, 0, 0) * upside_down.orientation;
  EXPECT_TRUE(std::isfinite(ground_frame(skeleton, 0, upside_down).heading));
}

TEST(Place, AtTheOriginFacingAsAsked) {
  Clip clip = astray();
  move_clip(to_origin(clip, 0), clip);
  move_clip(facing_at_start(clip, 0, 0.7), clip);
  const GroundFrame start = ground_frame(clip, 0, 0);
  EXPECT_NEAR(start.x, 0, 1e-6);
  EXPECT_NEAR(start.z, 0, 1e-6);
  EXPECT_NEAR(start.heading, 0.7, 1e-6);
  move_clip(turned_about_start(clip, 0, 0.4), clip);
  EXPECT_NEAR(ground_frame(clip, 0, 0).heading, 1.1, 1e-6);
  EXPECT_NEAR(ground_frame(clip, 0, 0).x, 0, 1e-6);
  // Height is another matter, and the motion is the same but for where it happens.
  EXPECT_NEAR(clip.frame_positions(0)[0].y(), astray().frame_positions(0)[0].y(), 1e-6);
  Clip back = swinging_human(31);
  move_clip(to_origin(back, 0), back);
  move_clip(facing_at_start(back, 0, 1.1), back);
  move_clip({Vec3(0, 0.4, 0), Quat::Identity()}, back);
  EXPECT_LT(distance(back, clip), 1e-5);
}

TEST(Place, TheLowestFootComesToTheGround) {
  Clip clip = astray();
  const auto feet = foot_joints(clip.skeleton, find_roles(clip.skeleton));
  EXPECT_EQ(feet.size(), 6u);
  move_clip(onto_ground(clip, feet), clip);
  float lowest = 10;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const int j : feet) {
      lowest = std::min(lowest, clip.frame_positions(f)[static_cast<std::size_t>(j)].y());
    }
  }
  EXPECT_NEAR(lowest, 0, 1e-6);
}

TEST(Place, NoFramesAreNoTrouble) {
  Clip clip = swinging_human(0);
  for (const Transform& move : {to_origin(clip, 0), facing_at_start(clip, 0, 1),
                                turned_about_start(clip, 0, 1), onto_ground(clip, {})}) {
    EXPECT_EQ(move.position, Vec3::Zero());
    EXPECT_EQ(move.orientation.vec(), Vec3::Zero());
  }
  move_clip({Vec3(1, 2, 3), Quat::Identity()}, clip);
  EXPECT_EQ(clip.frame_count(), 0);
}

TEST(Scale, ActorAndMotionTogether) {
  Clip clip = swinging_human(31);
  EXPECT_NEAR(reference_height(clip.skeleton), 1.75 * (1 - 0.008), 1e-9);
  ASSERT_TRUE(scale_clip(2, clip).ok());
  EXPECT_NEAR(reference_height(clip.skeleton), 3.5 * (1 - 0.008), 1e-9);
  EXPECT_LT((clip.frame_positions(9)[7] - 2 * swinging_human(31).frame_positions(9)[7]).norm(),
            1e-5f);
  EXPECT_EQ(clip.frame_orientations(9)[7].coeffs(),
            swinging_human(31).frame_orientations(9)[7].coeffs());
  EXPECT_TRUE(check(clip).ok());
  for (const double factor : {0.0, -1.0, double(NAN), double(HUGE_VAL), 1e300}) {
    Clip other = swinging_human(31);
    EXPECT_EQ(scale_clip(factor, other).error().code, "motion-scale") << factor;
    EXPECT_EQ(distance(other, swinging_human(31)), 0) << "half done";
  }
  Clip no_frames = swinging_human(0);
  EXPECT_EQ(scale_clip(1e308, no_frames).error().code, "motion-scale");
}

TEST(InPlace, AllOrOnlyTheEvenPart) {
  const Clip clip = astray();
  const Clip still = in_place(clip, 0, Travel::all);
  const Clip even = in_place(clip, 0, Travel::trend);
  const GroundFrame first = ground_frame(clip, 0, 0);
  double sway = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    EXPECT_NEAR(ground_frame(still, 0, f).x, first.x, 1e-5);
    EXPECT_NEAR(ground_frame(still, 0, f).z, first.z, 1e-5);
    EXPECT_NEAR(still.frame_positions(f)[0].y(), clip.frame_positions(f)[0].y(), 1e-6);
    sway = std::max(sway, std::abs(ground_frame(even, 0, f).x - first.x));
  }
  EXPECT_GT(sway, 0.02);
  EXPECT_NEAR(ground_frame(even, 0, 30).x, first.x, 1e-5);
  EXPECT_NEAR(ground_frame(even, 0, 30).z, first.z, 1e-5);
  EXPECT_EQ(in_place(swinging_human(0), 0, Travel::all).frame_count(), 0);
  EXPECT_EQ(in_place(swinging_human(1), 0, Travel::trend).positions, swinging_human(1).positions);
}

// Would fail if an engine's arithmetic gave another way than the one that was removed.
TEST(InPlace, CarriedAlongIsTheMotionBefore) {
  const Clip clip = astray();
  const GroundFrame first = ground_frame(clip, 0, 0);
  const GroundFrame last = ground_frame(clip, 0, clip.frame_count() - 1);
  const Vec3 velocity = Vec3(last.x - first.x, 0, last.z - first.z) / clip.duration();
  const Clip back = carried_along(in_place(clip, 0, Travel::trend), 0, {velocity, 0});
  EXPECT_LT(distance(back, clip), 1e-5);
  EXPECT_EQ(carried_along(swinging_human(0), 0, {velocity, 1}).frame_count(), 0);
}

// By the closed form of a circle: a character that faces +Z and turns to its left.
TEST(InPlace, CarriedAlongWhileTurningWalksACircle) {
  const double speed = 1.2, rate = 0.8, radius = speed / rate;
  Clip clip;
  clip.rate = 50;
  clip.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add("Foot", 0, {Vec3(0.1, 0, 0), Quat::Identity()});
  clip.resize(201);
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.set_pose(f, std::vector<Transform>{{Vec3(3, 1, 2), Quat::Identity()},
                                            {Vec3(3.1, 0, 2), Quat::Identity()}});
  }
  clip.provenance.removed_root_motion = RootMotion{Vec3(0, 0, speed), rate};
  const Clip moved = carried_along(clip, 0, *clip.provenance.removed_root_motion);
  EXPECT_FALSE(moved.provenance.removed_root_motion);
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double angle = rate * f / clip.rate;
    const Vec3 hips(3 + radius * (1 - std::cos(angle)), 1, 2 + radius * std::sin(angle));
    const Vec3 left(std::cos(angle), 0, -std::sin(angle));
    EXPECT_LT((moved.frame_positions(f)[0].cast<double>() - hips).norm(), 1e-5) << f;
    EXPECT_LT(
        (moved.frame_positions(f)[1].cast<double>() - (hips + 0.1 * left - Vec3(0, 1, 0))).norm(),
        1e-5)
        << f;
    EXPECT_NEAR(wrapped(ground_frame(moved, 0, f).heading - angle), 0, 1e-5);
  }
  EXPECT_LT(distance(carried_along(moved, 0, {Vec3(0, 0, -speed), -rate}), clip), 1e-5);
}

TEST(InPlace, AStillRootStaysWhereItIs) {
  Clip clip;
  clip.rate = 30;
  clip.skeleton.add("Root", -1, {});
  clip.skeleton.add("Hips", 0, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add("Spine", 1, {Vec3(0, 1.2, 0), Quat::Identity()});
  clip.resize(5);
  for (int f = 0; f < 5; ++f) {
    const Vec3 hips(0, 1, 0.3 * f);
    clip.set_pose(f, std::vector<Transform>{
                         {}, {hips, Quat::Identity()}, {hips + Vec3(0, 0.2, 0), Quat::Identity()}});
  }
  const Clip still = in_place(clip, 1, Travel::all);
  EXPECT_EQ(still.frame_positions(4)[0], Vec3f(0, 0, 0));
  EXPECT_NEAR(still.frame_positions(4)[1].z(), 0, 1e-6);
  EXPECT_NEAR(still.frame_positions(4)[2].z(), 0, 1e-6);
}

TEST(Retime, FasterAndAtAnotherRate) {
  const Clip clip = swinging_human(31);  // one second
  const auto fast = retime(clip, 30, 2, LastFrame::within);
  ASSERT_TRUE(fast.ok());
  EXPECT_EQ(fast->frame_count(), 16);
  EXPECT_EQ(fast->rate, 30);
  for (int f = 0; f < 16; ++f) {
    EXPECT_EQ(fast->frame_positions(f)[7], clip.frame_positions(2 * f)[7]);
  }
  const auto both = retime(clip, 60, 0.5, LastFrame::within);
  EXPECT_EQ(both->frame_count(), 121);
  EXPECT_EQ(retime(clip, 30, 1, LastFrame::within)->positions, clip.positions);
}

TEST(Retime, TheLastFrameStaysWhereALoopNeedsIt) {
  const Clip clip = swinging_human(31);
  const auto within = retime(clip, 30, 1.3, LastFrame::within);
  const auto kept = retime(clip, 30, 1.3, LastFrame::kept);
  EXPECT_EQ(within->frame_count(), 24);
  EXPECT_EQ(kept->frame_count(), 24);
  EXPECT_NE(within->frame_positions(23)[7], clip.frame_positions(30)[7]);
  EXPECT_LT((kept->frame_positions(23)[7] - clip.frame_positions(30)[7]).norm(), 1e-5f);
  EXPECT_EQ(retime(clip, 7, 1, LastFrame::kept)->frame_count(), 8);
  EXPECT_EQ(retime(clip, 0.1, 1, LastFrame::kept)->frame_count(), 2);
}

TEST(Retime, NonsenseAndFewFrames) {
  for (const double speed : {0.0, -1.0, double(NAN), double(HUGE_VAL), 1e308}) {
    const auto result = retime(swinging_human(31), 30, speed, LastFrame::within);
    if (speed < 1e300) {
      ASSERT_FALSE(result.ok()) << speed;
    }
    if (!result.ok()) {
      EXPECT_EQ(result.error().code, "motion-speed");
    }
  }
  EXPECT_EQ(retime(swinging_human(31), -1, 1, LastFrame::kept).error().code, "clip-rate");
  EXPECT_EQ(retime(swinging_human(31), 1e12, 1, LastFrame::kept).error().code, "clip-rate");
  EXPECT_EQ(retime(swinging_human(0), 60, 2, LastFrame::kept)->frame_count(), 0);
  EXPECT_EQ(retime(swinging_human(1), 60, 2, LastFrame::kept)->frame_count(), 1);
}

TEST(JointSelection, PatternsAndSubTrees) {
  const Skeleton skeleton = test::human_skeleton();
  const auto selected = [&](const JointSelection& selection) {
    std::string names;
    const auto flags = select_joints(skeleton, selection);
    EXPECT_TRUE(flags.ok());
    for (std::size_t j = 0; flags.ok() && j < flags->size(); ++j) {
      if ((*flags)[j]) names += skeleton.names[j] + " ";
    }
    return names;
  };
  EXPECT_EQ(selected({{"*Foot"}, {}}), "LeftFoot RightFoot ");
  EXPECT_EQ(selected({{"Spine?"}, {}}), "Spine1 Spine2 ");
  EXPECT_EQ(selected({{"L*t*m"}, {}}), "LeftArm LeftForeArm ");
  EXPECT_EQ(selected({{"Head"}, {"LeftHand"}}), "Head LeftHand LeftHand_end ");
  EXPECT_EQ(select_joints(skeleton, {}).value(),
            std::vector<std::uint8_t>(skeleton.names.size(), 1));
  for (const JointSelection& wrong :
       {JointSelection{{"Tail*"}, {}}, JointSelection{{}, {"Spine*"}}, JointSelection{{""}, {}}}) {
    EXPECT_EQ(select_joints(skeleton, wrong).error().code, "motion-joint");
  }
}

}  // namespace
}  // namespace krok
