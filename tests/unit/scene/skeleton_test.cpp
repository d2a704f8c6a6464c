// If these fail, poses come out wrong whenever they pass between joint and world coordinates.
#include "scene/skeleton.h"

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "scene/clip.h"

namespace krok {
namespace {

// A chain that bends by a quarter turn about z at each joint: 1 m up, then 1 m to -x, then down.
TEST(LocalToWorld, CarriesTransformsDownTheTree) {
  const std::vector<int> parents = {-1, 0, 1};
  const Quat quarter = from_rotation_vector(Vec3(0, 0, kPi / 2));
  const std::vector<Transform> local = {
      {Vec3(5, 0, 0), quarter}, {Vec3(0, 1, 0), quarter}, {Vec3(0, 1, 0), Quat::Identity()}};
  std::vector<Transform> world(3);
  local_to_world(parents, local, world);
  EXPECT_TRUE(world[0].position.isApprox(Vec3(5, 0, 0)));
  EXPECT_TRUE(world[1].position.isApprox(Vec3(4, 0, 0), 1e-12));
  EXPECT_TRUE(world[2].position.isApprox(Vec3(4, -1, 0), 1e-12));
  EXPECT_NEAR(angle_between(world[2].orientation, from_rotation_vector(Vec3(0, 0, kPi))), 0, 1e-12);
}

TEST(LocalToWorld, IsUndoneByWorldToLocal) {
  const std::vector<int> parents = {-1, 0, 0, 2, 3, 1};
  std::vector<Transform> local;
  for (int i = 0; i < 6; ++i) {
    local.push_back({Vec3(i, 1 - i, 0.3 * i), from_rotation_vector(Vec3(0.3 * i, -0.7, 1.1 * i))});
  }
  std::vector<Transform> world(6), back(6);
  local_to_world(parents, local, world);
  world_to_local(parents, world, back);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT((back[i].position - local[i].position).norm(), 1e-12);
    EXPECT_LT(angle_between(back[i].orientation, local[i].orientation), 1e-12);
  }
}

TEST(LocalToWorld, WorksInPlace) {
  const std::vector<int> parents = {-1, 0, 1};
  std::vector<Transform> local(3, {Vec3(0, 1, 0), from_rotation_vector(Vec3(0.2, 0.1, 0))});
  std::vector<Transform> world(3);
  local_to_world(parents, local, world);
  local_to_world(parents, local, local);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(local[i].position, world[i].position);
}

TEST(Skeleton, FindsJointsAndChildren) {
  Skeleton s;
  EXPECT_TRUE(s.empty());
  EXPECT_EQ(s.add("a", -1, {Vec3(1, 0, 0), Quat::Identity()}), 0);
  EXPECT_EQ(s.add("b", 0, {Vec3(1, 2, 0), Quat::Identity()}), 1);
  EXPECT_EQ(s.add("c", 0, {Vec3(1, 0, 7), Quat::Identity()}, true), 2);
  EXPECT_EQ(s.find("c"), 2);
  EXPECT_EQ(s.find("C"), -1);
  EXPECT_EQ(s.children(), (std::vector<std::vector<int>>{{1, 2}, {}, {}}));
  EXPECT_EQ(s.reference_local(0).position, Vec3(1, 0, 0));
  EXPECT_EQ(s.reference_local(1).position, Vec3(0, 2, 0));
  EXPECT_EQ(s.end_sites[2], 1);
  EXPECT_DOUBLE_EQ(reference_extent(s), 7);
  EXPECT_DOUBLE_EQ(reference_extent({}), 0);
}

TEST(DifferenceInStructure, SaysWhatDiffers) {
  Skeleton a;
  a.add("hips", -1, {});
  a.add("leg", 0, {});
  a.add("foot", 1, {});
  EXPECT_EQ(difference_in_structure(a, a), "");
  Skeleton moved = a;
  moved.reference[1].position.x() = 3;
  EXPECT_EQ(difference_in_structure(a, moved), "") << "reference poses are not compared";
  Skeleton renamed = a;
  renamed.names[1] = "shin";
  EXPECT_NE(difference_in_structure(a, renamed).find("shin"), std::string::npos);
  Skeleton rehung = a;
  rehung.parents[2] = 0;
  EXPECT_NE(difference_in_structure(a, rehung).find("parent of foot"), std::string::npos);
  Skeleton longer = a;
  longer.add("toe", 2, {});
  EXPECT_NE(difference_in_structure(a, longer).find("toe"), std::string::npos);
  EXPECT_NE(difference_in_structure(longer, a).find("toe"), std::string::npos);
}

TEST(Clip, CountsFramesAndSeconds) {
  Clip clip;
  EXPECT_EQ(clip.frame_count(), 0);
  EXPECT_EQ(clip.duration(), 0);
  clip.skeleton.add("a", -1, {});
  clip.skeleton.add("b", 0, {});
  clip.rate = 50;
  clip.resize(1);
  EXPECT_EQ(clip.duration(), 0);
  clip.resize(101);
  EXPECT_EQ(clip.frame_count(), 101);
  EXPECT_DOUBLE_EQ(clip.duration(), 2);
}

TEST(Clip, PosesComeBackNormalised) {
  Clip clip;
  clip.skeleton.add("a", -1, {});
  clip.skeleton.add("b", 0, {});
  clip.resize(2);
  const std::vector<Transform> pose = {{Vec3(1, 2, 3), from_rotation_vector(Vec3(0.1, 0.2, 0.3))},
                                       {Vec3(4, 5, 6), from_rotation_vector(Vec3(2, 0, 0))}};
  clip.set_pose(1, pose);
  clip.orientations[3].coeffs() *= 1.0005f;
  std::vector<Transform> back(2);
  clip.get_pose(1, back);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(back[j].position, pose[j].position);
    EXPECT_NEAR(back[j].orientation.norm(), 1, 1e-15);
    EXPECT_LT(angle_between(back[j].orientation, pose[j].orientation), 1e-6);
  }
  EXPECT_EQ(clip.frame_positions(0)[1], Vec3f::Zero());
  EXPECT_EQ(clip.frame_positions(1)[1], Vec3f(4, 5, 6));
}

}  // namespace
}  // namespace krok
