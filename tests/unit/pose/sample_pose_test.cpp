// Would fail if a packed clip did not show the clip's own poses, before, at, between and after its
// frames, or if an instruction set or a tail of joints changed a bit of what the reference gives.

#include "pose/packed_pose.h"

#include <gtest/gtest.h>

#include <limits>

#include "motion/sample.h"
#include "poses.h"

namespace krok {
namespace {

std::vector<Transform> local_pose(const Clip& clip, int frame) {
  std::vector<Transform> world(clip.skeleton.names.size()), local(world.size());
  clip.get_pose(frame, world);
  world_to_local(clip.skeleton.parents, world, local);
  return local;
}

std::vector<PoseBlock> sampled(const PackedClip& clip, double time) {
  std::vector<PoseBlock> pose(static_cast<std::size_t>(clip.blocks_per_pose()));
  sample_pose(clip, time, pose);
  return pose;
}

void expect_near(const Transform& a, const Transform& b, double position, double angle) {
  EXPECT_LT((a.position - b.position).norm(), position);
  EXPECT_LT(angle_between(a.orientation, b.orientation), angle);
}

TEST(PackPose, ComesBackAndFillsTheRestWithTheIdentity) {
  for (const int joints : {1, 15, 16, 17, 60}) {
    const Clip clip = test::random_clip(joints, 3, 5u);
    const auto local = local_pose(clip, 2);
    std::vector<PoseBlock> pose(static_cast<std::size_t>(pose_blocks(joints)));
    pack_pose(local, pose);
    const auto back = test::unpacked(pose, joints);
    for (std::size_t j = 0; j < local.size(); ++j) expect_near(back[j], local[j], 2e-7, 2e-7);
    const auto all = test::unpacked(pose, static_cast<int>(pose.size()) * PoseBlock::kLanes);
    for (std::size_t j = local.size(); j < all.size(); ++j) {
      EXPECT_EQ(all[j].position, Vec3::Zero());
      EXPECT_EQ(all[j].orientation.coeffs(), Quat::Identity().coeffs());
    }
  }
}

TEST(PackPose, WhatIsNoRotationBecomesTheIdentity) {
  std::vector<Transform> local(2);
  local[0].orientation = Quat(0, 0, 0, 0);
  local[1].orientation = Quat(std::numeric_limits<double>::quiet_NaN(), 0, 0, 1);
  std::vector<PoseBlock> pose(1);
  pack_pose(local, pose);
  for (const Transform& joint : test::unpacked(pose, 2)) {
    EXPECT_EQ(joint.orientation.coeffs(), Quat::Identity().coeffs());
  }
}

TEST(PackClip, NeighbouringFramesLieInOneHemisphere) {
  // Two full turns of a joint: its quaternion passes through every sign.
  Clip clip = test::random_clip(2, 40, 1u);
  for (int f = 0; f < 40; ++f) {
    const Quat turned = from_rotation_vector(Vec3(0, 0.35 * f, 0));
    clip.frame_orientations(f)[1] =
        (f % 3 == 0 ? Quat(Vec4(-turned.coeffs())) : turned).cast<float>();
  }
  const PackedClip packed = pack_clip(clip);
  for (int f = 1; f < packed.frames; ++f) {
    float dot = 0;
    for (int i = 0; i < 4; ++i) {
      dot += packed.frame(f)[0].rotation[i][1] * packed.frame(f - 1)[0].rotation[i][1];
    }
    EXPECT_GT(dot, 0) << f;
  }
}

TEST(SamplePose, AtAFrameGivesTheFrameBitForBit) {
  const Clip clip = test::random_clip(37, 20, 2u, 59.94);
  const PackedClip packed = pack_clip(clip);
  for (int f = 0; f < packed.frames; ++f) {
    EXPECT_TRUE(test::same_bits(sampled(packed, f / packed.rate), packed.frame(f))) << f;
  }
}

TEST(SamplePose, BetweenFramesGoesAsSampleDoes) {
  // sample() goes by slerp; the swing is under 5 degrees a frame.
  const Clip clip = test::swinging_clip(test::human_skeleton(), 30, 30);
  const PackedClip packed = pack_clip(clip);
  std::vector<Transform> world(clip.skeleton.names.size()), scratch(3 * world.size()),
      local(world.size());
  for (int i = 0; i <= 200; ++i) {
    const double time = clip.duration() * i / 200;
    sample(clip, time, world, scratch);
    world_to_local(clip.skeleton.parents, world, local);
    const auto pose = test::unpacked(sampled(packed, time), packed.joints);
    for (std::size_t j = 0; j < local.size(); ++j) expect_near(pose[j], local[j], 1e-6, 3e-6);
  }
}

TEST(SamplePose, LagsBehindSlerpNoMoreThanSaid) {
  for (const auto& [degrees, most] : {std::pair{30.0, 0.04}, {90.0, 1.0}}) {
    Clip clip;
    clip.skeleton.add("root", -1, {});
    clip.rate = 1;
    clip.resize(2);
    const Quat end = from_rotation_vector(Vec3(0, degrees * kRadiansPerDegree, 0));
    clip.orientations[1] = end.cast<float>();
    const PackedClip packed = pack_clip(clip);
    double worst = 0;
    for (double t = 0; t <= 1; t += 0.01) {
      const Quat q = test::unpacked(sampled(packed, t), 1)[0].orientation;
      worst = std::max(worst, angle_between(q, slerp(Quat::Identity(), end, t)));
    }
    EXPECT_LT(worst, most * kRadiansPerDegree) << degrees;
    EXPECT_GT(worst, 0.6 * most * kRadiansPerDegree) << degrees;
  }
}

TEST(SamplePose, HoldsTheEndsAndTakesNoNumberForTheBeginning) {
  const PackedClip packed = pack_clip(test::random_clip(5, 4, 3u));
  constexpr double endless = std::numeric_limits<double>::infinity();
  for (const double time : {-1.0, -endless, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(test::same_bits(sampled(packed, time), packed.frame(0))) << time;
  }
  for (const double time : {0.2, 7.0, endless}) {
    EXPECT_TRUE(test::same_bits(sampled(packed, time), packed.frame(3))) << time;
  }
}

TEST(SamplePose, OfNoFramesIsTheReferencePose) {
  Clip clip;
  clip.skeleton = test::random_skeleton(4, 9u);
  const PackedClip packed = pack_clip(clip);
  EXPECT_EQ(packed.duration(), 0);
  EXPECT_TRUE(test::same_bits(sampled(packed, 0.5), packed_reference(clip.skeleton)));
  const auto pose = test::unpacked(sampled(packed, 0), 4);
  for (int j = 0; j < 4; ++j) expect_near(pose[j], clip.skeleton.reference_local(j), 1e-6, 1e-6);
}

TEST(SamplePose, OfNoJointsIsNothing) {
  const PackedClip packed = pack_clip(Clip());
  sample_pose(packed, 0.5, {});
  EXPECT_EQ(packed.blocks_per_pose(), 0);
}

TEST(SamplePose, EveryInstructionSetGivesTheBitsOfTheReferenceTailsIncluded) {
  for (int joints = 1; joints <= 35; ++joints) {
    const PackedClip packed = pack_clip(test::random_clip(joints, 9, 4u));
    for (const double time : {0.0, 0.01, 0.1, 0.123, 0.25, 0.2666}) {
      std::vector<PoseBlock> expected(static_cast<std::size_t>(packed.blocks_per_pose()));
      sample_pose_reference(packed, time, expected);
      test::with_each_simd([&](const char* name) {
        EXPECT_TRUE(test::same_bits(sampled(packed, time), expected))
            << joints << " joints at " << time << " with " << name;
      });
    }
  }
}

}  // namespace
}  // namespace krok
