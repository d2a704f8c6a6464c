// If these fail, the viewer page draws a root on the floor as a giant bone, or heads and toes of
// captures without end sites not at all.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/pack_motion_internal.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"

namespace krok::draw {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

DrawnBones bones_of(const Skeleton& skeleton, std::vector<std::uint8_t> moves = {}) {
  Clip clip;
  clip.skeleton = skeleton;
  moves.resize(skeleton.names.size(), 0);
  return find_drawn_bones(clip, moves);
}

// `skeleton` below a root at the origin, with another joint on that root.
Skeleton with_root(const Skeleton& skeleton) {
  Skeleton result;
  result.add("Reference", -1, {});
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    result.add(skeleton.names[at], skeleton.parents[at] + 1, skeleton.reference[at],
               skeleton.end_sites[at] != 0);
  }
  Transform prop;
  prop.position = Vec3(1, 0, 0);
  result.add("ik_target", 0, prop);
  return result;
}

Skeleton without_end_sites(const Skeleton& skeleton) {
  Skeleton result;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (skeleton.end_sites[at] != 0) continue;
    const int parent = skeleton.parents[at];
    result.add(skeleton.names[at],
               parent < 0 ? parent : result.find(skeleton.names[static_cast<std::size_t>(parent)]),
               skeleton.reference[at]);
  }
  return result;
}

TEST(DrawnBones, HipsBelowARootAndItsPropsAreNoBones) {
  const Skeleton skeleton = with_root(test::human_skeleton());
  const DrawnBones bones = bones_of(skeleton);
  EXPECT_EQ(bones.hips, skeleton.find("Hips"));
  EXPECT_THAT(bones.loose, ElementsAre(skeleton.find("Hips"), skeleton.find("ik_target")));
}

TEST(DrawnBones, HipsThatAreTheRootHaveAllTheirBones) {
  const DrawnBones bones = bones_of(test::human_skeleton());
  EXPECT_EQ(bones.hips, 0);
  EXPECT_THAT(bones.loose, IsEmpty());
  EXPECT_THAT(bones.stubs, IsEmpty());  // every leaf is an end site
}

TEST(DrawnBones, WithoutRolesAChildThatMovesAgainstTheRootIsFollowed) {
  Skeleton tail;
  for (int joint = 0; joint < 5; ++joint) {
    Transform place;
    place.position = Vec3(0, 0, 0.2 * joint);
    tail.add("j" + std::to_string(joint), joint - 1, place);
  }
  EXPECT_EQ(bones_of(tail).hips, 0);
  const DrawnBones moving = bones_of(tail, {0, 1, 0, 0, 0});
  EXPECT_EQ(moving.hips, 1);
  EXPECT_THAT(moving.loose, ElementsAre(1));
}

// The ends that the skeleton had, within a quarter of their length.
TEST(DrawnBones, HeadAndToesWithoutEndSitesGetStubs) {
  const Skeleton whole = test::human_skeleton();
  const Skeleton skeleton = without_end_sites(whole);
  const DrawnBones bones = bones_of(skeleton);
  EXPECT_EQ(bones.stubs.size(), 5U);  // head, hands, toes
  for (const DrawnBones::Stub& stub : bones.stubs) {
    const std::string& name = skeleton.names[static_cast<std::size_t>(stub.joint)];
    const Vec3 end = whole.reference[static_cast<std::size_t>(whole.find(name + "_end"))].position -
                     skeleton.reference[static_cast<std::size_t>(stub.joint)].position;
    const Vec3 tip =
        skeleton.reference[static_cast<std::size_t>(stub.joint)].orientation * stub.tip;
    EXPECT_NEAR(tip.norm(), end.norm(), 0.35 * end.norm()) << name;
    EXPECT_GT(tip.normalized().dot(end.normalized()), 0.97) << name;
  }
}

TEST(DrawnBones, AFootWithoutToesPointsAhead) {
  const Skeleton whole = test::human_skeleton();
  Skeleton skeleton;
  for (int joint = 0; joint < whole.joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (whole.names[at].find("ToeBase") != std::string::npos) continue;
    const int parent = whole.parents[at];
    skeleton.add(whole.names[at],
                 parent < 0 ? parent : skeleton.find(whole.names[static_cast<std::size_t>(parent)]),
                 whole.reference[at], whole.end_sites[at] != 0);
  }
  const DrawnBones bones = bones_of(skeleton);
  ASSERT_EQ(bones.stubs.size(), 2U);
  for (const DrawnBones::Stub& stub : bones.stubs) {
    EXPECT_GT(stub.tip.z(), 0.1) << stub.tip.transpose();
    EXPECT_LT(std::abs(stub.tip.y()), 0.02) << stub.tip.transpose();
  }
}

}  // namespace
}  // namespace krok::draw
