// If these fail, things are compared that do not belong together.

#include "compare/matching.h"

#include <gtest/gtest.h>

#include "compare/clip_difference.h"
#include "compare/model_difference.h"

namespace krok::compare {
namespace {

using Names = std::vector<std::string>;

TEST(MatchLists, AutomaticIsByNameOnlyWhereAllAreUniqueAndTheSame) {
  const Names abc = {"a", "b", "c"};
  const auto matched = [](const Names& first, const Names& second) {
    return match_lists(first, second, Matching::automatic).pairs;
  };
  EXPECT_EQ(matched(abc, Names{"c", "a", "b"}), (Pairs{{0, 1}, {1, 2}, {2, 0}}));
  EXPECT_EQ(matched(abc, Names{"c", "a", "x"}), (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_EQ(matched(abc, Names{"c", "a"}), (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(matched(Names{"a", "a"}, Names{"a", "a"}), (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(matched(Names{}, abc), Pairs{});
}

TEST(MatchLists, OrderTakesNoNotice) {
  const ListMatch match = match_lists(Names{"a", "b"}, Names{"b", "a", "c"}, Matching::order);
  EXPECT_EQ(match.pairs, (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(match.only_second, std::vector<int>{2});
}

TEST(MatchLists, NamePairsWhatBothHaveAndTellsTheRest) {
  const ListMatch match =
      match_lists(Names{"a", "x", "a", ""}, Names{"", "b", "a", "a", "a"}, Matching::name);
  EXPECT_EQ(match.pairs, (Pairs{{0, 2}, {2, 3}, {3, 0}}));
  EXPECT_EQ(match.only_first, std::vector<int>{1});
  EXPECT_EQ(match.only_second, (std::vector<int>{1, 4}));
}

TEST(MatchJoints, NameGoesOnWithTheJointsThatBothHave) {
  const Names first = {"Hips", "Spine", "Tail"};
  const std::vector<int> first_parents = {-1, 0, 0};
  const Names second = {"Hips", "Head", "Spine"};
  const std::vector<int> second_parents = {-1, 2, 0};
  const auto named = match_joints(first, first_parents, second, second_parents);
  EXPECT_EQ(named.second_of_first, (std::vector<int>{0, 2, -1}));
  EXPECT_EQ(named.difference,
            "both have 3 joints; only in the first: Tail; only in the second: Head");
  const auto placed = match_joints(first, first_parents, second, second_parents, Matching::order);
  EXPECT_EQ(placed.difference, "the parent of Spine is Hips in the first and Spine in the second");
}

Clip two_joints(const char* second_name, double rate = 30) {
  Clip clip;
  clip.rate = rate;
  clip.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add(second_name, 0, {Vec3(0, 2, 0), Quat::Identity()});
  clip.resize(30);
  for (int f = 0; f < 30; ++f) clip.set_pose(f, clip.skeleton.reference);
  return clip;
}

TEST(ClipDifference, JointsOfOtherNamesAreComparedByPlaceOrPassedOver) {
  const Clip a = two_joints("Head");
  Clip b = two_joints("Kopf");
  for (int f = 0; f < 30; ++f) b.frame_positions(f)[1].x() += 0.5F;
  const auto by_place = difference(a, b, {}, Matching::order);
  EXPECT_TRUE(by_place->structure.empty());
  EXPECT_EQ(by_place->positions.largest, 0.5);
  ASSERT_EQ(by_place->joints.size(), 2u);
  EXPECT_TRUE(by_place->joints[0].positions.within());
  EXPECT_EQ(by_place->joints[1].positions.over, 30);
  const auto by_name = difference(a, b, {});
  EXPECT_EQ(by_name->structure.size(), 1u);
  EXPECT_EQ(by_name->positions.count, 30);
  EXPECT_TRUE(by_name->positions.within());
}

TEST(ClipDifference, RatesThatPartFramesByLessThanTheToleranceAreTheSame) {
  const Clip a = two_joints("Head", 30);
  const Clip b = two_joints("Head", 30.001);  // 32 microseconds at the last frame
  EXPECT_TRUE(difference(a, b, {})->same());
  EXPECT_FALSE(difference(a, b, {.time = 1e-5})->same());
  EXPECT_FALSE(difference(a, two_joints("Head", 31), {.time = 0.01})->same());
  EXPECT_TRUE(difference(a, two_joints("Head", 31), {.time = 0.05})->same());
  // A single frame tells nothing of its rate.
  EXPECT_FALSE(match_frames(1, 30, 1, 60, 1).differences.empty());
}

MorphSet two_targets() {
  MorphSet morphs;
  morphs.names = {"smile", "frown"};
  morphs.vertex_count = 2;
  morphs.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  return morphs;
}

TEST(MorphDifference, NamesTheTargetAndVertexThatDiffer) {
  MorphSet other = two_targets();
  EXPECT_TRUE(difference(two_targets(), other, {})->same());
  other.positions[3].z() = 0.25F;
  const auto found = difference(two_targets(), other, {});
  EXPECT_FALSE(found->same());
  EXPECT_EQ(found->positions.largest, 0.25);
  EXPECT_EQ(found->positions.where.target, 1);
  EXPECT_EQ(found->positions.where.vertex, 1);
}

TEST(MorphDifference, TargetsInAnotherOrderAreTheSameAndMissingOnesAreNamed) {
  MorphSet other = two_targets();
  std::swap(other.names[0], other.names[1]);
  std::swap(other.positions[0], other.positions[2]);
  std::swap(other.positions[1], other.positions[3]);
  EXPECT_TRUE(difference(two_targets(), other, {})->same());
  EXPECT_FALSE(difference(two_targets(), other, {}, Matching::order)->same());
  other.names[0] = "wink";
  const auto found = difference(two_targets(), other, {});
  ASSERT_EQ(found->structure.size(), 2u);
  EXPECT_EQ(found->structure[0], "target frown is only in the first");
  EXPECT_EQ(found->structure[1], "target wink is only in the second");
  EXPECT_EQ(found->compared_targets, 1);
}

}  // namespace
}  // namespace krok::compare
