// If these fail, one actor is said to be of different sizes by different tools, poses or units.

#include "roles/body_frame.h"

#include <gtest/gtest.h>

#include "support/human_skeleton.h"

namespace krok {
namespace {

TEST(Stature, IsThatOfTheSegments) {
  const Skeleton skeleton = test::human_skeleton(1.8);
  const RoleMap roles = find_roles(skeleton);
  const auto stature = stature_of(skeleton, roles);
  ASSERT_TRUE(stature);
  EXPECT_NEAR(stature->metres, 1.8, 0.1);
  EXPECT_GE(stature->uncertainty, std::abs(stature->metres - 1.8));
  EXPECT_LT(stature->uncertainty, 0.2);
}

// Crouched, lying or in other units, it is the same actor.
TEST(Stature, IsThatOfNoPose) {
  Skeleton skeleton = test::human_skeleton();
  const RoleMap roles = find_roles(skeleton);
  const double standing = stature_of(skeleton, roles)->metres;
  const int knee = skeleton.find("LeftLeg"), foot = skeleton.find("LeftFoot");
  ASSERT_TRUE(knee >= 0 && foot >= 0);
  const auto at = [&](int joint) -> Vec3& {
    return skeleton.reference[static_cast<std::size_t>(joint)].position;
  };
  at(foot) = at(knee) + (at(foot) - at(knee)).norm() * Vec3::UnitZ();
  for (Transform& joint : skeleton.reference) {
    joint.position = 100 * (Eigen::AngleAxisd(1.1, Vec3::UnitX()) * joint.position);
  }
  EXPECT_NEAR(stature_of(skeleton, roles)->metres, 100 * standing, 1e-9);
}

TEST(Stature, NeedsLimbs) {
  Skeleton skeleton = test::human_skeleton();
  EXPECT_FALSE(stature_of(skeleton, RoleMap()));
  const RoleMap roles = find_roles(skeleton);
  for (Transform& joint : skeleton.reference) joint.position.setZero();
  EXPECT_FALSE(stature_of(skeleton, roles));
}

}  // namespace
}  // namespace krok
