// If these fail, a camera looks elsewhere than it was told, or turns over where it looks straight
// down.

#include "camera/look_at.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/quaternion.h"

namespace krok {
namespace {

const Vec3 kForward = -Vec3::UnitZ();

// The well-known look-at matrix, its columns written out.
Mat3 look_at_matrix(const Vec3& eye, const Vec3& target) {
  const Vec3 back = (eye - target).normalized();
  const Vec3 right(back.z(), 0, -back.x());  // up x back
  Mat3 axes;
  axes << right.normalized(), back.cross(right.normalized()), back;
  return axes;
}

TEST(LookAt, IsTheUsualMatrix) {
  for (const Vec3& target : {Vec3(0, 1, 0), Vec3(3, -2, 5), Vec3(-7, 4, 0.1), Vec3(1, 2, 9)}) {
    const Vec3 eye(1, 2, 3);
    const Quat found = look_at(eye, target, Quat(0.5, 0.5, -0.5, 0.5));
    EXPECT_LT((found.toRotationMatrix() - look_at_matrix(eye, target)).norm(), 1e-12);
  }
}

TEST(LookAt, KeepsItsUpWhereItLooksStraightDown) {
  const Quat before = look_at({0, 3, 0.5}, {0, 0, 0}, Quat::Identity());
  const Quat down = look_at({0, 3, 0}, {0, 0, 0}, before);
  EXPECT_LT((down * kForward - Vec3(0, -1, 0)).norm(), 1e-12);
  // The shortest way there is about the camera's own right, which stays.
  EXPECT_LT((down * Vec3::UnitX() - before * Vec3::UnitX()).norm(), 1e-12);
  EXPECT_LT((down * Vec3::UnitY() - Vec3(0, 0, -1)).norm(), 1e-12);
}

TEST(LookAt, WithoutADirectionItStaysAsItWas) {
  const Quat before(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(look_at({1, 2, 3}, {1, 2, 3}, before).coeffs(), before.coeffs());
  EXPECT_EQ(look_at({1, 2, 3}, {1 + 1e-16, 2, 3}, before).coeffs(), before.coeffs());
  EXPECT_EQ(look_at({1, 2, 3}, {nan, 2, 3}, before).coeffs(), before.coeffs());
}

TEST(LookAt, APathThatBeginsStraightDownTakesTheUpThatComes) {
  const std::vector<Vec3> eyes(3, Vec3(0, 5, 0));
  // Later it looks towards +X, so +X is up in the picture from the start.
  const auto turned = look_at(eyes, std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(turned.size(), 3u);
  EXPECT_LT((turned[0] * Vec3::UnitY() - Vec3(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT(angle_between(turned[0], turned[2]), std::atan(0.2) + 1e-9);
  // If it never does, the top is towards -Z; looking up, towards +Z.
  const auto down = look_at(eyes, std::vector<Vec3>(3, Vec3(0, 0, 0)));
  EXPECT_LT((down[2] * Vec3::UnitY() - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((down[2] * kForward - Vec3(0, -1, 0)).norm(), 1e-12);
  const auto up = look_at(eyes, std::vector<Vec3>(3, Vec3(0, 9, 0)));
  EXPECT_LT((up[0] * Vec3::UnitY() - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((up[0] * kForward - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(look_at(std::vector<Vec3>(2, Vec3::Zero()), std::vector<Vec3>(2, Vec3::Zero()))[1].w(),
            1.0);
}

TEST(LookAt, OverThePoleItTurnsOnlyAsMuchAsItMust) {
  // Past a target just below: frames within 0.1 degrees of the vertical keep their up.
  std::vector<Vec3> eyes, targets;
  for (int i = -5; i <= 5; ++i) {
    eyes.emplace_back(0, 10, 0.001 * i);
    targets.emplace_back(0, 0, 0);
  }
  const auto turned = look_at(eyes, targets);
  for (std::size_t i = 1; i < turned.size(); ++i) {
    EXPECT_LT(angle_between(turned[i - 1], turned[i]), 1.1e-4) << i;
  }
}

TEST(LookingFrom, StandsWhereItsAnglesSay) {
  const Quat left = looking_from(kPi / 2, 0);
  EXPECT_LT((left * Vec3::UnitZ() - Vec3(1, 0, 0)).norm(), 1e-12);  // from +X
  const Quat above = looking_from(0, kPi / 6);
  EXPECT_LT((above * Vec3::UnitZ() - Vec3(0, 0.5, std::sqrt(0.75))).norm(), 1e-12);
  EXPECT_LT((above.toRotationMatrix() - look_at_matrix(above * Vec3::UnitZ(), Vec3::Zero())).norm(),
            1e-12);
  const Quat down = looking_from(kPi / 2, kPi / 2);
  EXPECT_LT((down * kForward - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT((down * Vec3::UnitY() - Vec3(-1, 0, 0)).norm(), 1e-12);
}

TEST(Rolled, TiltsToTheRightAndKeepsTheDirection) {
  const Quat camera = look_at({0, 1, 4}, {1, 1, 0}, Quat::Identity());
  const Quat tilted = rolled(camera, 0.3);
  EXPECT_LT((tilted * kForward - camera * kForward).norm(), 1e-12);
  const Vec3 up = camera.conjugate() * (tilted * Vec3::UnitY());
  EXPECT_NEAR(up.x(), std::sin(0.3), 1e-12);
  EXPECT_NEAR(up.y(), std::cos(0.3), 1e-12);
}

}  // namespace
}  // namespace krok
