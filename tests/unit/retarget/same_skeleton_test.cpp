// If these fail, a motion that is brought onto the skeleton it was made for comes back changed.
#include "retarget/same_skeleton.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;
using retarget::Method;

bool same_bits(const Clip& a, const Clip& b) {
  return a.positions.size() == b.positions.size() &&
         std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Vec3f)) ==
             0 &&
         std::memcmp(a.orientations.data(), b.orientations.data(),
                     a.orientations.size() * sizeof(Quatf)) == 0;
}

TEST(SameSkeleton, OntoItselfAMotionIsUnchangedToTheBit) {
  for (const Skeleton& skeleton : {human_skeleton(), with_turned_joints(human_skeleton()),
                                   with_other_axes(human_skeleton(), 3)}) {
    const Clip clip = swinging_clip(skeleton, 20, 30);
    const auto result = transfer(clip, skeleton);
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, Method::same_skeleton);
    EXPECT_EQ(result->report.scale, 1.0);
    EXPECT_TRUE(same_bits(result->clip, clip));
    EXPECT_EQ(result->clip.rate, clip.rate);
  }
}

TEST(SameSkeleton, BonesThatStretchInTheMotionKeepStretching) {
  Clip clip = swinging_clip(human_skeleton(), 10, 30);
  for (Vec3f& position : clip.positions) position.x() *= 1.3f;
  const auto result = transfer(clip, human_skeleton());
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(same_bits(result->clip, clip));
}

TEST(SameSkeleton, OntoAScaledCopyAMotionIsScaled) {
  const Skeleton skeleton = with_turned_joints(human_skeleton());
  const Clip clip = swinging_clip(skeleton, 20, 30);
  for (const double scale : {0.01, 0.7, 1.9, 100.0}) {
    const auto result = transfer(clip, scaled(skeleton, scale));
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->report.method, Method::same_skeleton);
    EXPECT_NEAR(result->report.scale / scale, 1, 1e-9);
    EXPECT_LT(largest_distance(result->clip, clip, scale), 1e-5 * scale);
    EXPECT_EQ(result->clip.orientations[7].coeffs(), clip.orientations[7].coeffs());
  }
}

TEST(SameSkeleton, AnotherReferencePoseOfTheSameBonesChangesNothing) {
  const Skeleton skeleton = with_turned_joints(human_skeleton());
  const Clip clip = swinging_clip(skeleton, 10, 30);
  Skeleton other = posed(skeleton, "LeftArm", from_rotation_vector(Vec3(0.2, 0.3, -1)));
  other = posed(other, "RightUpLeg", from_rotation_vector(Vec3(0.7, 0, 0.3)));
  other = posed(other, "Hips", from_rotation_vector(Vec3(0.1, 2, 0)));
  const auto result = transfer(clip, other);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::same_skeleton);
  EXPECT_TRUE(same_bits(result->clip, clip));
}

TEST(SameSkeleton, TheOrderOfJointsMayDiffer) {
  const Skeleton skeleton = human_skeleton();
  const Clip clip = swinging_clip(skeleton, 5, 30);
  Skeleton other;
  // Legs before the trunk.
  std::vector<int> order = {0};
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.names[at(j)].find("Leg") != std::string::npos ||
        skeleton.names[at(j)].find("Foot") != std::string::npos ||
        skeleton.names[at(j)].find("Toe") != std::string::npos) {
      order.push_back(j);
    }
  }
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    if (std::find(order.begin(), order.end(), j) == order.end()) order.push_back(j);
  }
  for (const int j : order) {
    const int parent = skeleton.parents[at(j)];
    other.add(skeleton.names[at(j)], parent < 0 ? -1 : other.find(skeleton.names[at(parent)]),
              skeleton.reference[at(j)], skeleton.end_sites[at(j)] != 0);
  }
  const auto result = transfer(clip, other);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::same_skeleton);
  const int to = other.find("LeftHand");
  const int from = skeleton.find("LeftHand");
  EXPECT_EQ(result->clip.frame_positions(3)[at(to)], clip.frame_positions(3)[at(from)]);
}

TEST(SameSkeleton, OneLongerBoneMakesAnotherSkeleton) {
  const Skeleton skeleton = human_skeleton();
  EXPECT_TRUE(retarget::same_skeleton(skeleton, skeleton).has_value());
  Skeleton longer = skeleton;
  longer.reference[at(longer.find("LeftHand_end"))].position.x() += 0.01;
  EXPECT_FALSE(retarget::same_skeleton(skeleton, longer).has_value());
  Skeleton renamed = skeleton;
  renamed.names.back() += "x";
  EXPECT_FALSE(retarget::same_skeleton(skeleton, renamed).has_value());
}

// Would fail if a clip whose reference pose is a step was "corrected" on its own character, as
// either file has joints that the other lacks: a root, a prop, fingers.
TEST(SameSkeleton, EitherMayHaveMoreJoints) {
  const auto below = [](const std::string& root, const Skeleton& skeleton) {
    Skeleton rooted;
    rooted.add(root, -1, {}, false);
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      rooted.add(skeleton.names[at(j)], skeleton.parents[at(j)] + 1, skeleton.reference[at(j)],
                 skeleton.end_sites[at(j)] != 0);
    }
    return rooted;
  };
  const Skeleton skeleton = with_turned_joints(human_skeleton());
  Skeleton stride = posed(skeleton, "LeftUpLeg", from_rotation_vector(Vec3(-0.6, 0, 0)));
  stride = below("Scene", posed(stride, "RightLeg", from_rotation_vector(Vec3(0.8, 0, 0))));
  const int camera = stride.add("Camera", 0, {Vec3(3, 2, 1), Quat::Identity()}, false);
  const Clip clip = swinging_clip(stride, 20, 30);
  Skeleton hero = below("Reference", skeleton);
  const int hand = hero.find("LeftHand");
  const int prop =
      hero.add("Sword", hand,
               hero.reference[at(hand)] * Transform{Vec3(0, 0.2, 0), Quat::Identity()}, false);
  const auto result = transfer(clip, hero);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::same_skeleton);
  EXPECT_EQ(result->report.following_target, (std::vector<int>{0, prop}));
  EXPECT_EQ(result->report.unused_source, (std::vector<int>{0, camera}));
  for (int j = 1; j <= skeleton.joint_count(); ++j) {
    EXPECT_EQ(result->clip.frame_positions(7)[at(j)], clip.frame_positions(7)[at(j)]);
    EXPECT_EQ(result->clip.frame_orientations(7)[at(j)].coeffs(),
              clip.frame_orientations(7)[at(j)].coeffs());
  }
  const auto positions = result->clip.frame_positions(7);
  EXPECT_NEAR((positions[at(prop)] - positions[at(hand)]).norm(), 0.2, 1e-6);

  const RoleMap roles = find_roles(stride), of_hero = find_roles(hero);
  const auto same = [&](const Skeleton& target) {
    return retarget::same_person(stride, roles, target, of_hero);
  };
  ASSERT_TRUE(same(hero).has_value());
  EXPECT_NEAR(same(scaled(hero, 0.5))->scale, 0.5, 1e-9);
  Skeleton longer = hero;
  longer.reference[at(longer.find("LeftFoot"))].position.y() -= 0.02;
  EXPECT_FALSE(same(longer).has_value());
  Skeleton twisted = hero;
  const Vec3 bone = hero.reference_local(hero.find("LeftFoot")).position.normalized();
  Quat& knee = twisted.reference[at(twisted.find("LeftLeg"))].orientation;
  knee = knee * from_rotation_vector(kPi / 2 * bone);
  EXPECT_FALSE(same(twisted).has_value());
}

// Takes of one character whose file shows another pose: where no mesh binds the limbs, that is
// their reference pose. Would fail if such takes were retargeted, with feet 60 degrees off.
TEST(SameSkeleton, APoseOfTheFileDoesNotMakeItAnother) {
  const Skeleton skeleton = with_turned_joints(human_skeleton());
  const auto twisted = [](const Skeleton& from, const std::string& side) {
    const Vec3 bone = from.reference[at(from.find(side + "Hand"))].position -
                      from.reference[at(from.find(side + "ForeArm"))].position;
    return posed(from, side + "ForeArm", from_rotation_vector(1.9 * bone.normalized()));
  };
  Skeleton shown = twisted(skeleton, "Left");
  shown = posed(shown, "RightLeg", from_rotation_vector(Vec3(0.8, 0, 0)));
  const Clip clip = swinging_clip(shown, 20, 30);
  Skeleton hero = skeleton;
  const int finger = hero.find("LeftHand_end");
  ASSERT_GE(finger, 0);
  hero.reference[at(finger)].position.y() += 0.005;
  const auto result = transfer(clip, hero);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->report.method, Method::same_skeleton);
  // Both forearms turned are other axes.
  const Skeleton other = twisted(shown, "Right");
  const auto roles = find_roles(hero);
  EXPECT_FALSE(retarget::same_person(other, roles, hero, roles).has_value());
}

// Under other names only if the bones show it and no role says otherwise.
TEST(SameSkeleton, UnderOtherNamesItMustBeThatOfTheSameBody) {
  const Skeleton skeleton = with_turned_joints(human_skeleton());
  Skeleton renamed = skeleton;
  for (std::string& name : renamed.names) name = "other:" + name;
  const RoleMap roles = find_roles(skeleton);
  const auto same = [&](const Skeleton& target, const RoleMap& target_roles) {
    return retarget::same_body(skeleton, roles, target, target_roles);
  };
  ASSERT_TRUE(same(renamed, roles).has_value());
  EXPECT_NEAR(same(scaled(renamed, 0.5), roles)->scale, 0.5, 1e-9);
  RoleMap sides = roles;
  std::swap(sides.roles[at(skeleton.find("LeftArm"))], sides.roles[at(skeleton.find("RightArm"))]);
  EXPECT_FALSE(same(renamed, sides).has_value());
  Skeleton twisted = renamed;
  Quat& end = twisted.reference[at(skeleton.find("LeftHand"))].orientation;
  end = end * from_rotation_vector(Vec3(0.01, 0, 0));
  EXPECT_FALSE(same(twisted, roles).has_value());
  RoleMap nobody;
  nobody.roles.resize(roles.roles.size());
  EXPECT_FALSE(same(renamed, nobody).has_value());
}

TEST(SameSkeleton, SkeletonsWithoutLengthsAreTheSameAtScaleOne) {
  Skeleton point;
  point.add("a", -1, {});
  point.add("b", 0, {});
  const auto same = retarget::same_skeleton(point, point);
  ASSERT_TRUE(same.has_value());
  EXPECT_EQ(same->scale, 1.0);
}

TEST(SameSkeleton, AMotionWithoutFramesGivesOne) {
  const auto result = transfer(resting(human_skeleton()), human_skeleton());
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->clip.frame_count(), 0);
}

}  // namespace
}  // namespace krok
