// If these fail, repaired frames jump, or bones change their length in them.

#include "scene/clip.h"

#include <gtest/gtest.h>

#include "math/quaternion.h"

namespace krok {
namespace {

// An upper and a lower bone of 2 and 1 m, and six frames of which the first and last are set.
Clip bent_arm() {
  Clip clip;
  clip.skeleton.add("upper", -1, {});
  clip.skeleton.add("lower", 0, {Vec3(2, 0, 0), Quat::Identity()});
  clip.skeleton.add("end", 1, {Vec3(3, 0, 0), Quat::Identity()}, true);
  clip.resize(6);
  const auto set = [&](int frame, const Vec3& root, double shoulder, double elbow) {
    std::vector<Transform> local = {{root, axis_rotation(Axis::z, shoulder)},
                                    {Vec3(2, 0, 0), axis_rotation(Axis::z, elbow)},
                                    {Vec3(1, 0, 0), Quat::Identity()}};
    std::vector<Transform> world(3);
    local_to_world(clip.skeleton.parents, local, world);
    clip.set_pose(frame, world);
  };
  set(0, Vec3(0, 1, 0), 0, 0);
  set(5, Vec3(5, 1, 0), 2.5, 1.5);
  return clip;
}

TEST(FillFramesBetween, TurnsEvenlyAndKeepsBoneLengths) {
  Clip clip = bent_arm();
  const Clip before = clip;
  fill_frames_between(clip, 0, 5);
  for (int frame = 0; frame < 6; ++frame) {
    std::vector<Transform> pose(3);
    clip.get_pose(frame, pose);
    EXPECT_LT((pose[0].position - Vec3(frame, 1, 0)).norm(), 1e-6);
    EXPECT_NEAR((pose[1].position - pose[0].position).norm(), 2, 1e-6);
    EXPECT_NEAR((pose[2].position - pose[1].position).norm(), 1, 1e-6);
    EXPECT_LT(pose[0].orientation.angularDistance(axis_rotation(Axis::z, 0.5 * frame)), 1e-6);
    EXPECT_LT(pose[1].orientation.angularDistance(axis_rotation(Axis::z, 0.8 * frame)), 1e-6);
  }
  for (const int end : {0, 5}) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(clip.frame_positions(end)[j], before.frame_positions(end)[j]);
    }
  }
}

TEST(FillFramesBetween, NeighboursHaveNothingBetweenThem) {
  Clip clip = bent_arm();
  const Clip before = clip;
  fill_frames_between(clip, 2, 3);
  EXPECT_EQ(clip.positions, before.positions);
}

}  // namespace
}  // namespace krok
