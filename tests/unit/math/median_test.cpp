// If these fail, where a foot stands is led astray by single frames, or depends on the direction in
// which the world's axes lie.

#include "math/window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "math/quaternion.h"

namespace krok {
namespace {

// Of a convex quadrilateral's corners the median is where the diagonals cross; of a triangle with
// an angle of over 120 degrees that corner.
TEST(MedianPoint, OfFourAndOfThreePoints) {
  const std::vector<Vec3> corners = {{0, 0, 0}, {4, 0, 0}, {6, 6, 0}, {0, 2, 0}};
  EXPECT_LT((median_point(corners) - Vec3(4.0 / 3, 4.0 / 3, 0)).norm(), 1e-6);
  const std::vector<Vec3> flat = {{-5, 0, 1}, {0, 0.4, 1}, {5, 0, 1}};
  EXPECT_LT((median_point(flat) - flat[1]).norm(), 1e-5);
  EXPECT_EQ(median_point({}), Vec3(0, 0, 0));
  EXPECT_EQ(median_point(std::vector<Vec3>(9, Vec3(1, 2, 3))), Vec3(1, 2, 3));
}

TEST(MedianPoint, TurnsWithItsPointsAndPassesOverOutliers) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) {
    points.push_back({0.01 * std::sin(7.1 * i), 0.01 * std::cos(3.3 * i), 0.01 * std::sin(i)});
  }
  for (int i = 0; i < 8; ++i) points.push_back({5, -3, 0.1 * i});
  const Vec3 median = median_point(points);
  EXPECT_LT(median.norm(), 0.005);
  const Quat turn = axis_rotation(Axis::y, 0.7) * axis_rotation(Axis::x, -1.1);
  std::vector<Vec3> turned;
  for (const Vec3& point : points) turned.push_back(turn * point);
  EXPECT_LT((median_point(turned) - turn * median).norm(), 1e-8);
}

TEST(MedianPlace, HasTheMedianHeightWhateverIsBelow) {
  const std::vector<Vec3> points = {{0, 1, 0}, {2, 2, 0}, {2, 9, 2}, {0, 4, 2}};
  EXPECT_LT((median_place(points) - Vec3(1, 3, 1)).norm(), 1e-6);
}

}  // namespace
}  // namespace krok
