// If these fail, sound captures are called beyond sense, or those that floats spoil are not.

#include "capture/far_values.h"

#include <gtest/gtest.h>

#include <cmath>

namespace krok {
namespace {

std::vector<Transform> at(const std::vector<Vec3>& places) {
  std::vector<Transform> reference;
  for (const Vec3& place : places) reference.push_back({place, Quat::Identity()});
  return reference;
}

TEST(FarValues, TheLimitGoesByTheLargestExtent) {
  EXPECT_DOUBLE_EQ(farthest_position(at({{0, 0, 0}, {0.4, 1.8, 0}})), 18000);
  // Where it stands does not matter.
  EXPECT_DOUBLE_EQ(farthest_position(at({{500, 0, 0}, {500, 0, -3}})), 30000);
}

TEST(FarValues, SmallAndBrokenSkeletonsHaveALimit) {
  EXPECT_DOUBLE_EQ(farthest_position({}), 10000);
  EXPECT_DOUBLE_EQ(farthest_position(at({{1, 2, 3}})), 10000);
  EXPECT_DOUBLE_EQ(farthest_position(at({{0, 0, 0}, {0.2, 0, 0}})), 10000);
  EXPECT_EQ(farthest_position(at({{0, 0, 0}, {1e300, 0, 0}})), 1e9);
  EXPECT_EQ(farthest_position(at({{0, 0, 0}, {INFINITY, 0, 0}})), 1e9);
}

TEST(FarValues, TheyAddUp) {
  FarValues all;
  EXPECT_FALSE(all.any());
  FarValues one, other;
  one.add_rotation(7);
  other.add_rotation(3);
  other.add_rotation(9);
  other.add_position(20);
  all.add(one);
  all.add(other);
  EXPECT_TRUE(all.any());
  EXPECT_EQ(all.first_rotation, 3u);
  EXPECT_EQ(all.rotations, 3u);
  EXPECT_EQ(all.first_position, 20u);
  EXPECT_EQ(all.positions, 1u);
}

}  // namespace
}  // namespace krok
