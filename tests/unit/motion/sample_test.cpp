// If these fail, motion between frames stretches bones, jumps, or resampling changes what it should
// keep.
#include "motion/sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "math/quaternion.h"

namespace krok {
namespace {

// A two-bone arm that swings about z by 0.1 rad a frame, its root moving along x by 1 m a frame.
Clip swinging_arm(int frames, double rate) {
  Clip clip;
  clip.rate = rate;
  clip.skeleton.add("shoulder", -1, {});
  clip.skeleton.add("elbow", 0, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add("hand", 1, {Vec3(0, 1.7, 0), Quat::Identity()});
  clip.resize(frames);
  for (int f = 0; f < frames; ++f) {
    const Quat swing = from_rotation_vector(Vec3(0, 0, 0.1 * f));
    const std::vector<Transform> local = {
        {Vec3(f, 0, 0), swing}, {Vec3(0, 1, 0), swing}, {Vec3(0, 0.7, 0), Quat::Identity()}};
    std::vector<Transform> world(3);
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(f, world);
  }
  return clip;
}

std::vector<Transform> sampled(const Clip& clip, double time) {
  std::vector<Transform> pose(clip.skeleton.names.size()), scratch(3 * pose.size());
  sample(clip, time, pose, scratch);
  return pose;
}

void expect_same(const std::vector<Transform>& a, const std::vector<Transform>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_EQ(a[j].position, b[j].position);
    EXPECT_EQ(a[j].orientation.coeffs(), b[j].orientation.coeffs());
  }
}

std::vector<Transform> frame(const Clip& clip, int f) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(f, pose);
  return pose;
}

TEST(Sample, GivesTheFrameAtItsTime) {
  for (const double rate : {24.0, 30.0, 29.97002997, 120.0}) {
    const Clip clip = swinging_arm(50, rate);
    for (int f = 0; f < 50; ++f) expect_same(sampled(clip, f / rate), frame(clip, f));
  }
}

TEST(Sample, KeepsBoneLengthsBetweenFrames) {
  const Clip clip = swinging_arm(10, 30);
  for (double time = 0; time < 0.3; time += 0.0037) {
    const auto pose = sampled(clip, time);
    EXPECT_NEAR((pose[1].position - pose[0].position).norm(), 1.0, 1e-6);
    EXPECT_NEAR((pose[2].position - pose[1].position).norm(), 0.7, 1e-6);
    EXPECT_NEAR(pose[0].position.x(), time * 30, 1e-6);
    EXPECT_LT(angle_between(pose[2].orientation, from_rotation_vector(Vec3(0, 0, 0.2 * time * 30))),
              1e-6);
  }
}

TEST(Sample, IsClampedToTheClip) {
  const Clip clip = swinging_arm(10, 30);
  for (const double time : {-1.0, -1e300, -std::numeric_limits<double>::infinity()}) {
    expect_same(sampled(clip, time), frame(clip, 0));
  }
  for (const double time :
       {9.0 / 30, 0.31, 100.0, 1e300, std::numeric_limits<double>::infinity()}) {
    expect_same(sampled(clip, time), frame(clip, 9));
  }
  expect_same(sampled(clip, std::numeric_limits<double>::quiet_NaN()), frame(clip, 0));
}

TEST(Sample, AClipWithoutFramesGivesTheReferencePose) {
  const Clip clip = swinging_arm(0, 30);
  EXPECT_EQ(sampled(clip, 1)[2].position, Vec3(0, 1.7, 0));
}

TEST(Sample, OneFrameStandsStill) {
  const Clip clip = swinging_arm(1, 30);
  for (const double time : {-1.0, 0.0, 0.5}) expect_same(sampled(clip, time), frame(clip, 0));
}

TEST(Sample, TakesTheShortWayBetweenOppositeSigns) {
  Clip clip = swinging_arm(2, 30);
  for (int j = 0; j < 3; ++j) clip.orientations[static_cast<std::size_t>(3 + j)].coeffs() *= -1.0f;
  expect_same(sampled(clip, 0), frame(clip, 0));
  EXPECT_LT(
      angle_between(sampled(clip, 0.5 / 30)[0].orientation, from_rotation_vector(Vec3(0, 0, 0.05))),
      1e-6);
}

bool same_bytes(const Clip& a, const Clip& b) {
  return a.positions.size() == b.positions.size() &&
         std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Vec3f)) ==
             0 &&
         std::memcmp(a.orientations.data(), b.orientations.data(),
                     a.orientations.size() * sizeof(Quatf)) == 0;
}

TEST(Resample, TheSameRateChangesNothing) {
  for (const double rate : {30.0, 29.97002997, 119.88}) {
    const Clip clip = swinging_arm(400, rate);
    const auto result = resample(clip, rate);
    ASSERT_TRUE(result.ok());
    EXPECT_TRUE(same_bytes(*result, clip));
  }
}

TEST(Resample, UpAndDownAgainChangesNothing) {
  const Clip clip = swinging_arm(61, 30);
  const auto up = resample(clip, 120);
  ASSERT_TRUE(up.ok());
  EXPECT_EQ(up->frame_count(), 241);
  EXPECT_DOUBLE_EQ(up->duration(), clip.duration());
  const auto down = resample(*up, 30);
  ASSERT_TRUE(down.ok());
  EXPECT_TRUE(same_bytes(*down, clip));
}

TEST(Resample, StopsAtTheLastMomentWithinTheClip) {
  const Clip clip = swinging_arm(11, 10);  // one second
  EXPECT_EQ(resample(clip, 10)->frame_count(), 11);
  EXPECT_EQ(resample(clip, 3)->frame_count(), 4);
  EXPECT_EQ(resample(clip, 2.5)->frame_count(), 3);  // 0, 0.4 and 0.8 s
  EXPECT_EQ(resample(clip, 0.5)->frame_count(), 1);
}

TEST(Resample, NoFramesAndOneFrame) {
  EXPECT_EQ(resample(swinging_arm(0, 30), 60)->frame_count(), 0);
  const auto one = resample(swinging_arm(1, 30), 60);
  EXPECT_EQ(one->frame_count(), 1);
  EXPECT_EQ(one->rate, 60);
}

TEST(Resample, RefusesWhatMakesNoSense) {
  const Clip clip = swinging_arm(11, 10);
  for (const double rate : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(), 1e9, 1e300, 1e-9}) {
    const auto result = resample(clip, rate);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "clip-rate");
  }
  Clip slow = clip;
  slow.rate = 1e-3;  // hours
  const auto result = resample(slow, 1e5);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "clip-too-long");
}

}  // namespace
}  // namespace krok
