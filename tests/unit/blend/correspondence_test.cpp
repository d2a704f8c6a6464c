// If these fail, a left step of one motion is blended with a right one of another.

#include "blend/correspondence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace krok::blend {
namespace {

MotionKeys keys_of(const std::vector<std::string>& names, double first, double step) {
  MotionKeys keys;
  for (std::size_t i = 0; i < names.size(); ++i) {
    keys.keytimes.push_back({first + step * static_cast<double>(i), names[i]});
  }
  return keys;
}

using Names = std::vector<std::string>;

TEST(Correspondence, AllKeytimesWithBeginningAndEnd) {
  const MotionKeys a = keys_of({"left_strike", "right_off"}, 0.2, 0.3);
  const MotionKeys b = keys_of({"left_strike", "right_off"}, 0.1, 0.7);
  const std::vector<KeyedMotion> motions = {{"a", 1, &a}, {"b", 2, &b}};
  const auto found = match_keytimes(motions);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->names, (Names{"begin", "left_strike", "right_off", "end"}));
  EXPECT_EQ(found->times[0], (std::vector<double>{0, 0.2, 0.5, 1}));
  EXPECT_EQ(found->times[1][3], 2);
  EXPECT_TRUE(found->notes.empty());
  EXPECT_TRUE(check(*found).ok());
}

TEST(Correspondence, NoBeginningWhereAMotionHasNone) {
  const MotionKeys a = keys_of({"x", "y"}, 0.0, 0.3);
  const MotionKeys b = keys_of({"x", "y"}, 0.1, 0.7);
  const std::vector<KeyedMotion> motions = {{"a", 1, &a}, {"b", 2, &b}};
  EXPECT_EQ(match_keytimes(motions)->names, (Names{"x", "y", "end"}));
}

// The clip's own frames must not be lost for a keytime a moment after the first of them.
TEST(Correspondence, AKeytimeAtTheBeginningIsTheBeginning) {
  const MotionKeys a = keys_of({"x", "y"}, 0.0014, 0.3), b = keys_of({"x", "y"}, 0.1, 0.7);
  const std::vector<KeyedMotion> motions = {{"a", 0.31, &a, 0.033}, {"b", 2, &b, 0.033}};
  const auto found = match_keytimes(motions);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->names, (Names{"x", "y"}));
  EXPECT_EQ(found->times[0], (std::vector<double>{0, 0.31}));
  EXPECT_EQ(found->times[1][0], 0.1);
}

TEST(Correspondence, MomentsTooCloseTogetherAreThinnedOut) {
  const Names names = {"a", "b", "c", "d"};
  MotionKeys one = keys_of(names, 0.5, 0.5), other = keys_of(names, 0.5, 0.5);
  one.keytimes[1].time = 0.51;    // b, just behind a
  other.keytimes[2].time = 1.99;  // c, just before d
  const std::vector<KeyedMotion> motions = {{"one", 3, &one, 0.033}, {"other", 3, &other, 0.033}};
  const auto found = match_keytimes(motions);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->names, (Names{"begin", "a", "c", "end"}));
  EXPECT_EQ(found->notes.size(), 2u);
}

TEST(Correspondence, TheLongestRunThatAllHave) {
  const Names cycle = {"left_strike", "right_off", "right_strike", "left_off"};
  Names first, second;
  for (std::size_t i = 0; i < 7; ++i) first.push_back(cycle[i % 4]);
  for (std::size_t i = 2; i < 8; ++i) second.push_back(cycle[i % 4]);
  const MotionKeys a = keys_of(first, 0.2, 0.3), b = keys_of(second, 0.1, 0.4);
  const std::vector<KeyedMotion> motions = {{"a", 3, &a}, {"b", 3, &b}};
  const auto found = match_keytimes(motions);
  ASSERT_TRUE(found.ok());
  // From the first's third name on there are five, which is where the second begins.
  EXPECT_EQ(found->names.size(), 5u);
  EXPECT_EQ(found->names.front(), "right_strike");
  EXPECT_NEAR(found->times[0][0], 0.8, 1e-12);
  EXPECT_NEAR(found->times[1][0], 0.1, 1e-12);
  EXPECT_EQ(found->notes.size(), 2u);
}

// In a slow walk a foot may leave just before the other comes down, in a quick one just after.
TEST(Correspondence, EventsThatChangePlacesDoNotEndTheStretch) {
  const MotionKeys a = keys_of({"ls", "ro", "rs", "lo", "ls", "ro", "rs"}, 0.2, 0.3);
  const MotionKeys b = keys_of({"ls", "ro", "lo", "rs", "ls", "ro", "rs", "lo"}, 0.2, 0.3);
  const std::vector<KeyedMotion> motions = {{"a", 3, &a}, {"b", 3, &b}};
  const auto found = match_keytimes(motions);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->names.size(), 6u);
  EXPECT_EQ(found->names.front(), "ls");
  EXPECT_EQ(found->names.back(), "rs");
  EXPECT_NEAR(found->times[1].back(), 2.0, 1e-12);
}

TEST(Correspondence, NothingInCommonIsSaid) {
  const MotionKeys a = keys_of({"x", "y"}, 0.2, 0.3), b = keys_of({"v", "x"}, 0.1, 0.4), none;
  const std::vector<KeyedMotion> unlike = {{"a", 3, &a}, {"b", 3, &b}};
  EXPECT_EQ(match_keytimes(unlike).error().code, "blend-keys");
  const std::vector<KeyedMotion> empty = {{"a", 3, &a}, {"b", 3, &none}};
  const auto error = match_keytimes(empty);
  ASSERT_FALSE(error.ok());
  EXPECT_NE(error.error().message.find("b has no keytimes"), std::string::npos);
}

TEST(Correspondence, EndsAloneNeedTime) {
  EXPECT_EQ(ends_alone(std::vector<double>{1, 2})->times[1], (std::vector<double>{0, 2}));
  EXPECT_EQ(ends_alone(std::vector<double>{1, 0}).error().code, "blend-duration");
  EXPECT_EQ(ends_alone(std::vector<double>{std::nan("")}).error().code, "blend-duration");
}

TEST(Correspondence, FaultsAreFound) {
  Correspondence faulty;
  EXPECT_FALSE(check(faulty).ok());
  faulty.names = {"a", "b"};
  faulty.times = {{0, 1}, {1, 1}};
  EXPECT_EQ(check(faulty).error().code, "blend-keys");
  faulty.times = {{0, 1}, {1}};
  EXPECT_EQ(check(faulty).error().code, "blend-keys");
  faulty.times = {{0, 1}, {0, std::nan("")}};
  EXPECT_EQ(check(faulty).error().code, "blend-keys");
}

}  // namespace
}  // namespace krok::blend
