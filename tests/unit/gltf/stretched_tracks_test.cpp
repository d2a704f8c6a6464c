// If these fail, characters whose joints change scale play otherwise in viewers than their motion
// says, or get nodes that they do not need.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <functional>

#include "formats/gltf/joint_tracks.h"
#include "math/quaternion.h"

namespace krok {
namespace {

constexpr int kJoints = 4, kFrames = 9;

// A chain that bends, 30 cm a bone.
Clip bending_chain() {
  Clip clip;
  for (int j = 0; j < kJoints; ++j) {
    clip.skeleton.add("joint " + std::to_string(j), j - 1,
                      {Vec3(0, 0.3 * j, 0), from_rotation_vector(Vec3(0, 0, 0.2 * j))});
  }
  clip.resize(kFrames);
  return clip;
}

// As a viewer with scales on nodes has it: each joint scaled by `scale`, those below inherit it.
Stretches set_chain(const std::function<Vec3(int frame, int joint)>& scale, Clip& clip) {
  Stretches stretches;
  for (int f = 0; f < kFrames; ++f) {
    Mat4 world = Mat4::Identity();
    std::vector<Transform> pose;
    for (int j = 0; j < kJoints; ++j) {
      Mat4 local = Transform{Vec3(0, j == 0 ? 0.1 * f : 0.3, 0),
                             from_rotation_vector(Vec3(0.3 * std::sin(f + j), 0.2, 0.1 * f))}
                       .matrix();
      local.topLeftCorner<3, 3>() = (local.topLeftCorner<3, 3>() * scale(f, j).asDiagonal()).eval();
      world = world * local;
      const Mat3 linear = world.topLeftCorner<3, 3>();
      // The polar decomposition by the square root of L^T L, not by the code under test.
      const Eigen::SelfAdjointEigenSolver<Mat3> solver(Mat3(linear.transpose() * linear));
      Mat3 stretch = solver.operatorSqrt();
      if (linear.determinant() < 0) stretch = -stretch;
      pose.push_back({world.topRightCorner<3, 1>(), Quat(Mat3(linear * stretch.inverse()))});
      stretches.push_back(Stretch::of(stretch));
    }
    clip.set_pose(f, pose);
  }
  return stretches;
}

double largest_difference(const Clip& clip, const Stretches& stretches,
                          const gltf::JointTracks& tracks) {
  double worst = 0;
  std::vector<Transform> pose(kJoints);
  std::vector<Mat4> shown(kJoints);
  for (int f = 0; f < kFrames; ++f) {
    clip.get_pose(f, pose);
    gltf::TrackPoses(clip.skeleton.parents, tracks).at(f, shown);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const Stretch& stretch = stretches[static_cast<std::size_t>(f) * pose.size() + j];
      const Mat4 off = shown[j] - joint_to_world(pose[j], stretch);
      worst = std::max(worst, off.cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

int nodes_added(const gltf::JointTracks& tracks) {
  int count = 0;
  for (const auto& joint : tracks.joints) count += joint.inner_rotations.empty() ? 0 : 1;
  return count;
}

// Scales of nodes come back as scales of nodes, although each joint's own transform is sheared by
// those above it.
TEST(StretchedTracks, ScalesThatNodesHaveNeedNoMoreNodes) {
  Clip clip = bending_chain();
  const Stretches stretches = set_chain(
      [](int f, int j) { return Vec3(1 + 0.05 * f, 1 - 0.03 * j, 0.8 + 0.02 * f * j); }, clip);
  double largest_error = 1;
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip, stretches, largest_error);
  ASSERT_TRUE(tracks.ok());
  EXPECT_EQ(nodes_added(*tracks), 0);
  EXPECT_TRUE(tracks->are_stretched());
  EXPECT_LT(largest_difference(clip, stretches, *tracks), 1e-5);
  EXPECT_LT(largest_error, 1e-5);
}

TEST(StretchedTracks, AMirroredJointIsMirroredAndOthersAreNot) {
  Clip clip = bending_chain();
  const Stretches stretches =
      set_chain([](int, int j) { return j == 2 ? Vec3(-1, 1.5, 1) : Vec3(1, 1, 1); }, clip);
  double largest_error = 1;
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip, stretches, largest_error);
  ASSERT_TRUE(tracks.ok());
  EXPECT_EQ(nodes_added(*tracks), 0);
  EXPECT_TRUE(tracks->joints[0].scales.empty());
  EXPECT_LT(largest_difference(clip, stretches, *tracks), 1e-5);
}

// What no chain of scaled nodes gives: a joint that is sheared while its parent is not.
TEST(StretchedTracks, AShearGetsANodeOfItsOwn) {
  Clip clip = bending_chain();
  Stretches stretches = set_chain([](int, int) { return Vec3(1, 1, 1); }, clip);
  for (int f = 0; f < kFrames; ++f) {
    const float shear = 0.1f * static_cast<float>(f);
    stretches[static_cast<std::size_t>(f * kJoints + 1)] = {1.5f, 1, 0.7f, shear, 0, 0.1f};
  }
  double largest_error = 1;
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip, stretches, largest_error);
  ASSERT_TRUE(tracks.ok());
  // The joint, and its child, which takes the shear back.
  EXPECT_EQ(nodes_added(*tracks), 2);
  EXPECT_LT(largest_difference(clip, stretches, *tracks), 1e-5);
  EXPECT_LT(largest_error, 1e-5);
  // From frame to frame the axes turn little, or viewers would show a twist between frames.
  for (const auto& joint : tracks->joints) {
    for (std::size_t f = 1; f < joint.inner_rotations.size(); ++f) {
      const Quat a = joint.inner_rotations[f - 1].cast<double>().normalized();
      const Quat b = joint.inner_rotations[f].cast<double>().normalized();
      EXPECT_LT(angle_between(a, b), 0.5);
    }
  }
}

TEST(StretchedTracks, WhatVanishesTakesItsChildrenWithIt) {
  Clip clip = bending_chain();
  Stretches stretches = set_chain([](int, int) { return Vec3(1, 1, 1); }, clip);
  for (int j = 1; j < kJoints; ++j) {
    const auto last = static_cast<std::size_t>((kFrames - 1) * kJoints);
    stretches[last + static_cast<std::size_t>(j)] = {0, 0, 0, 0, 0, 0};
    clip.positions[last + static_cast<std::size_t>(j)] = clip.positions[last + 1];
  }
  double largest_error = 1;
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip, stretches, largest_error);
  ASSERT_TRUE(tracks.ok());
  EXPECT_LT(largest_difference(clip, stretches, *tracks), 1e-5);
  // A child that stays elsewhere cannot be shown, and that is said.
  clip.positions.back() += Vec3f(0, 1, 0);
  ASSERT_TRUE(gltf::joint_tracks(clip.skeleton, clip, stretches, largest_error).ok());
  EXPECT_NEAR(largest_error, 1, 1e-5);
}

TEST(StretchedTracks, RigidJointsGiveTheTracksTheyGaveBefore) {
  Clip clip = bending_chain();
  set_chain([](int, int) { return Vec3(1, 1, 1); }, clip);
  double largest_error = 1;
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip, {}, largest_error);
  const auto before = gltf::joint_tracks(clip.skeleton, clip);
  EXPECT_EQ(largest_error, 0);
  EXPECT_FALSE(tracks->are_stretched());
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_EQ(tracks->joints[j].translations, before->joints[j].translations);
    EXPECT_EQ(tracks->joints[j].rotations.size(), before->joints[j].rotations.size());
  }
}

}  // namespace
}  // namespace krok
