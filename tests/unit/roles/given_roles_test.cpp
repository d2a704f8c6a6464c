// If these fail, what a user says of joints is not heeded, or breaks what was found around them.
#include <gtest/gtest.h>

#include "roles/roles.h"
#include "support/human_skeleton.h"
#include "support/skeleton_text.h"

namespace krok {
namespace {

using test::skeleton_from_text;

GivenRole given(const Skeleton& skeleton, const std::string& joint, const std::string& label) {
  auto role = parse_role_label(label);
  EXPECT_TRUE(role.has_value()) << label;
  EXPECT_GE(skeleton.find(joint), 0) << joint;
  role->joint = skeleton.find(joint);
  return *role;
}

std::string joint_of(const Skeleton& skeleton, const RoleMap& map, Role role) {
  const int joint = map.joint(role);
  return joint < 0 ? "-" : skeleton.names[static_cast<std::size_t>(joint)];
}

// A body of unknown names and no shape to go by: all joints are in one place.
Skeleton unknown_body() {
  return skeleton_from_text(
      "b0 .b1 ..b2 ...b3 ....b4 ...b5 ....b6 .....b7 ......b8 .......b9 ...c5 ....c6 .....c7 "
      "......c8 .......c9 .d1 ..d2 ...d3 .e1 ..e2 ...e3");
}

TEST(GivenRoles, AFewMakeAWholeBody) {
  const Skeleton skeleton = unknown_body();
  EXPECT_FALSE(find_roles(skeleton).humanoid);
  const auto map = find_roles(
      skeleton,
      std::vector{given(skeleton, "b0", "hips"), given(skeleton, "b4", "head"),
                  given(skeleton, "b6", "left_upper_arm"), given(skeleton, "b8", "left_hand"),
                  given(skeleton, "c6", "right_upper_arm"), given(skeleton, "c8", "right_hand"),
                  given(skeleton, "d1", "left_upper_leg"), given(skeleton, "d3", "left_foot"),
                  given(skeleton, "e1", "right_upper_leg"), given(skeleton, "e3", "right_foot")});
  ASSERT_TRUE(map.ok());
  EXPECT_TRUE(map->humanoid);
  EXPECT_EQ(joint_of(skeleton, *map, Role::chest), "b2");
  EXPECT_EQ(joint_of(skeleton, *map, Role::spine), "b1");
  EXPECT_EQ(joint_of(skeleton, *map, Role::neck), "b3");
  EXPECT_EQ(joint_of(skeleton, *map, Role::left_lower_arm), "b7");
  EXPECT_EQ(joint_of(skeleton, *map, Role::left_lower_leg), "d2");
  EXPECT_EQ(joint_of(skeleton, *map, Role::left_fingers), "b9");
}

TEST(GivenRoles, OverrideWhatTheNamesSay) {
  const Skeleton skeleton = test::human_skeleton();
  const auto map = find_roles(
      skeleton, std::vector{given(skeleton, "Spine1", "chest"), given(skeleton, "Neck", "none")});
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(joint_of(skeleton, *map, Role::chest), "Spine1");
  EXPECT_EQ(joint_of(skeleton, *map, Role::neck), "-");
  EXPECT_EQ(map->roles[static_cast<std::size_t>(skeleton.find("Spine2"))], Role::spine);
  EXPECT_TRUE(map->humanoid);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string& name = skeleton.names[static_cast<std::size_t>(j)];
    EXPECT_EQ(map->given[static_cast<std::size_t>(j)], name == "Spine1" || name == "Neck") << name;
  }
  const auto less = find_roles(skeleton, std::vector{given(skeleton, "LeftFoot", "helper")});
  ASSERT_TRUE(less.ok());
  EXPECT_EQ(less->roles[static_cast<std::size_t>(skeleton.find("LeftFoot"))], Role::helper);
}

TEST(GivenRoles, NothingGivenIsTheSameAsNone) {
  const Skeleton skeleton = test::human_skeleton();
  const auto map = find_roles(skeleton, std::span<const GivenRole>());
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->roles, find_roles(skeleton).roles);
  EXPECT_TRUE(map->given.empty());
}

TEST(GivenRoles, AJointTakesARoleFromTheOneFoundForIt) {
  const Skeleton skeleton = skeleton_from_text(
      "Hips .Spine ..Neck ...Head ..LeftShoulder ...LeftArm ....LeftForeArm .....LeftHand "
      ".....Paw ..RightShoulder ...RightArm ....RightForeArm .....RightHand .LeftUpLeg ..LeftLeg "
      "...LeftFoot .RightUpLeg ..RightLeg ...RightFoot");
  const auto map = find_roles(skeleton, std::vector{given(skeleton, "Paw", "left_hand")});
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->joints(Role::left_hand), std::vector<int>{skeleton.find("Paw")});
  EXPECT_EQ(joint_of(skeleton, *map, Role::left_lower_arm), "LeftForeArm");
}

TEST(GivenRoles, FingersCanBeGiven) {
  const Skeleton skeleton = unknown_body();
  const auto map = find_roles(skeleton, std::vector{given(skeleton, "b9", "left_index_2")});
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->finger_joint(Role::left_fingers, {Finger::index, 2}), skeleton.find("b9"));
  EXPECT_EQ(role_label(*map, skeleton.find("b9")), "left_index_2");
}

TEST(GivenRoles, OneRoleCannotBeGivenToTwo) {
  const Skeleton skeleton = unknown_body();
  for (const char* label : {"left_hand", "hips", "left_index_1"}) {
    const auto map = find_roles(
        skeleton, std::vector{given(skeleton, "b8", label), given(skeleton, "b9", label)});
    ASSERT_FALSE(map.ok()) << label;
    EXPECT_EQ(map.error().code, "role-twice");
    EXPECT_EQ(map.error().joint, "b9");
  }
  EXPECT_TRUE(find_roles(skeleton, std::vector{given(skeleton, "b1", "spine"),
                                               given(skeleton, "b2", "spine")})
                  .ok());
}

TEST(GivenRoles, ALimbMustHangTogether) {
  const Skeleton skeleton = unknown_body();
  const auto map = find_roles(skeleton, std::vector{given(skeleton, "b6", "left_upper_arm"),
                                                    given(skeleton, "c8", "left_hand")});
  ASSERT_FALSE(map.ok());
  EXPECT_EQ(map.error().code, "role-order");
  EXPECT_TRUE(map.error().joint == "b6" || map.error().joint == "c8") << map.error().joint;
  EXPECT_NE(map.error().message.find("is not a descendant of"), std::string::npos)
      << map.error().message;
}

TEST(GivenRoles, LabelsAreReadBack) {
  for (int r = 0; r <= static_cast<int>(Role::helper); ++r) {
    const auto role = static_cast<Role>(r);
    ASSERT_TRUE(parse_role(role_name(role)).has_value());
    EXPECT_EQ(*parse_role(role_name(role)), role);
    EXPECT_EQ(parse_role_label(role_name(role))->role, role);
  }
  EXPECT_EQ(parse_role_label("right_thumb_3")->role, Role::right_fingers);
  EXPECT_EQ(parse_role_label("right_thumb_3")->finger, (FingerJoint{Finger::thumb, 3}));
  for (const char* text : {"", "hand", "left_", "LEFT_HAND", "left_index", "middle_index_1"}) {
    EXPECT_FALSE(parse_role_label(text).has_value()) << text;
  }
}

TEST(GivenRoles, WhatAHumanoidLacksIsListed) {
  EXPECT_TRUE(missing_roles(find_roles(test::human_skeleton())).empty());
  const Skeleton half = skeleton_from_text(
      "Hips .Spine ..Neck ..LeftShoulder ...LeftArm ....LeftForeArm .....LeftHand "
      "..RightShoulder ...RightArm ....RightForeArm .....RightHand");
  EXPECT_EQ(missing_roles(find_roles(half)),
            (std::vector{Role::left_upper_leg, Role::left_lower_leg, Role::left_foot,
                         Role::right_upper_leg, Role::right_lower_leg, Role::right_foot}));
  EXPECT_EQ(missing_roles(find_roles({})).size(), 12u);
}

}  // namespace
}  // namespace krok
