// If these fail, limbs of skeletons with names or shapes of their own are mistaken or not found;
// those of well-known exporters stand in exporters_test.cpp.
#include "roles/roles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "roles/joint_names.h"
#include "support/skeleton_text.h"
#include "unit/roles/role_text.h"

namespace krok {
namespace {

using test::joint_name;
using test::skeleton_from_text;
using test::table;

TEST(Roles, TheSideIsFoundInAnySpelling) {
  for (const char* name :
       {"L_Hand", "LHand", "lHand", "LeftHand", "Left_Hand", "left hand", "Hand.L", "Hand_L",
        "Hand_l", "hand-left", "HandLeft", "LEFTHAND", "LEFT_HAND", "lhand", "Lhand", "ns:LeftHand",
        "a|b|L.Hand", "lft_hand"}) {
    Skeleton skeleton;
    skeleton.add(name, -1, {});
    const auto names = read_joint_names(skeleton);
    EXPECT_EQ(names[0].part, Part::hand) << name;
    EXPECT_EQ(names[0].side, Side::left) << name;
  }
  for (const char* name :
       {"R_Hand", "RHand", "rHand", "RightHand", "Hand.R", "hand_r", "RIGHTHAND"}) {
    Skeleton skeleton;
    skeleton.add(name, -1, {});
    EXPECT_EQ(read_joint_names(skeleton)[0].side, Side::right) << name;
  }
  for (const char* name : {"LowerBack", "Root", "Reference", "L5", "Rib", "lowerneck"}) {
    Skeleton skeleton;
    skeleton.add(name, -1, {});
    EXPECT_EQ(read_joint_names(skeleton)[0].side, Side::middle) << name;
  }
}

TEST(Roles, NamesAreSplitIntoWords) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(name_tokens("mixamorig:LeftForeArm2"), (Words{"left", "fore", "arm", "2"}));
  EXPECT_EQ(name_tokens("CC_Base_L_Thigh"), (Words{"cc", "base", "l", "thigh"}));
  EXPECT_EQ(name_tokens("LThigh"), (Words{"l", "thigh"}));
  EXPECT_EQ(name_tokens("Arm:Left:Upper"), (Words{"arm", "left", "upper"})) << "no namespace";
  EXPECT_EQ(name_tokens("toe1-1.R"), (Words{"toe", "1", "1", "r"}));
  EXPECT_EQ(name_tokens("LUArm"), (Words{"l", "u", "arm"}));
  EXPECT_EQ(name_tokens(""), Words{});
  EXPECT_EQ(name_tokens("::"), Words{});
}

// Copies and constraint rigs add words behind the names, the same behind all.
TEST(Roles, WordsBehindAllNamesSayNothing) {
  const Skeleton skeleton = skeleton_from_text(
      "hips_dup .spine_dup ..neck_dup ...head_dup ..l_shoulder_dup ...l_elbow_dup ....l_hand_dup "
      "..r_shoulder_dup ...r_elbow_dup ....r_hand_dup .l_thigh_dup ..l_knee_dup ...l_foot_dup "
      ".r_thigh_dup ..r_knee_dup ...r_foot_dup");
  const RoleMap map = find_roles(skeleton);
  EXPECT_TRUE(map.humanoid) << table(skeleton, map);
  EXPECT_EQ(joint_name(skeleton, map, Role::left_lower_arm), "l_elbow_dup");
  EXPECT_EQ(joint_name(skeleton, map, Role::hips), "hips_dup");
}

TEST(Roles, AHeadWithoutANameIsWhatLeadsOnBetweenTheArms) {
  const std::string limbs =
      "Pelvis .L_Thigh ..L_Knee ...L_Foot .R_Thigh ..R_Knee ...R_Foot .T9 ..L_Shoulder ...L_Elbow "
      "....L_Hand ..R_Shoulder ...R_Elbow ....R_Hand";
  const Skeleton vertebrae = skeleton_from_text(limbs + " ..C7 ...C3 ....Atlas .....top!");
  const RoleMap map = find_roles(vertebrae);
  EXPECT_TRUE(map.humanoid) << table(vertebrae, map);
  EXPECT_EQ(joint_name(vertebrae, map, Role::head), "Atlas");
  EXPECT_EQ(joint_name(vertebrae, map, Role::chest), "T9");
  // A vertebra leads on, a bow and a scarf do not: Rigify names no head.
  const Skeleton dressed = skeleton_from_text(
      limbs + " ..Bow ...Bow_L ...Bow_R ..Spine4 ...Spine5 ....Hair1 ....Hair2 ..Scarf");
  EXPECT_EQ(joint_name(dressed, find_roles(dressed), Role::head), "Spine5");
  // Two ways lead on, or what does is no part of a body, or of one side.
  for (const char* more : {" ..C7 ..Mast", " ..Tail", " ..LeftWing", ""}) {
    const Skeleton headless = skeleton_from_text(limbs + more);
    EXPECT_EQ(joint_name(headless, find_roles(headless), Role::head), "-") << more;
  }
}

// A second foot beside the toes was taken for toes, and turned both feet by 56 degrees.
TEST(Roles, AFootBesideTheToesIsAHelper) {
  const Skeleton skeleton = skeleton_from_text(
      "Hips .Spine ..Neck ...Head ..LeftArm ...LeftForeArm ....LeftHand ..RightArm "
      "...RightForeArm ....RightHand .LeftUpLeg ..LeftLeg ...LeftFoot ....L_Foot ....LeftToeBase "
      ".RightUpLeg ..RightLeg ...RightFoot ....R_Foot ....RightToeBase");
  const RoleMap map = find_roles(skeleton);
  EXPECT_EQ(map.roles[static_cast<std::size_t>(skeleton.find("R_Foot"))], Role::helper)
      << table(skeleton, map);
  EXPECT_EQ(joint_name(skeleton, map, Role::right_toes), "RightToeBase");
}

TEST(Roles, AHandThatHangsUnderNoArmIsNotTheHand) {
  const Skeleton skeleton = skeleton_from_text(
      "Hips .LeftHand .Spine ..LeftShoulder ...LeftArm ....LeftForeArm .....LeftHand2 "
      "..RightShoulder ...RightArm ....RightForeArm .....RightHand ..Neck ...Head .LeftUpLeg "
      "..LeftLeg ...LeftFoot .RightUpLeg ..RightLeg ...RightFoot");
  const RoleMap map = find_roles(skeleton);
  EXPECT_TRUE(map.humanoid);
  EXPECT_EQ(joint_name(skeleton, map, Role::left_hand), "LeftHand2");
}

// Names that give a leg one joint short: the one above, a helper by its name, has a thigh's length.
// Where its bone is short (CMU's) or the leg is whole without it, it stays a helper.
TEST(Roles, AHelperWithTheLengthOfAThighIsOne) {
  Skeleton skeleton = skeleton_from_text(
      "Hips .LHipJoint ..LLeg ...LFoot .RHipJoint ..RLeg ...RFoot .Spine ..LArm ...LForeArm "
      "....LHand ..RArm ...RForeArm ....RHand ..Head");
  const auto lengths = [&](double thigh) {
    for (const char side : {'L', 'R'}) {
      const Vec3 hip(side == 'L' ? 0.1 : -0.1, 0.9, 0), knee = hip - Vec3(0, thigh, 0);
      const auto place = [&](const char* name) -> Vec3& {
        return skeleton.reference[static_cast<std::size_t>(skeleton.find(side + std::string(name)))]
            .position;
      };
      place("HipJoint") = hip;
      place("Leg") = knee;
      place("Foot") = knee - Vec3(0, 0.4, 0);
    }
  };
  lengths(0.42);
  const RoleMap map = find_roles(skeleton);
  EXPECT_TRUE(map.humanoid) << table(skeleton, map);
  EXPECT_EQ(joint_name(skeleton, map, Role::left_upper_leg), "LHipJoint");
  EXPECT_EQ(joint_name(skeleton, map, Role::left_lower_leg), "LLeg");
  EXPECT_EQ(joint_name(skeleton, map, Role::right_foot), "RFoot");
  lengths(0.05);
  EXPECT_EQ(joint_name(skeleton, find_roles(skeleton), Role::left_upper_leg), "-");
}

TEST(Roles, PartOfAPersonKeepsItsRoles) {
  const Skeleton skeleton = skeleton_from_text(
      "Hips .Spine ..Neck ...Head ..LeftShoulder ...LeftArm ....LeftForeArm .....LeftHand "
      "..RightShoulder ...RightArm ....RightForeArm .....RightHand");
  const RoleMap map = find_roles(skeleton);
  EXPECT_FALSE(map.humanoid);
  EXPECT_EQ(joint_name(skeleton, map, Role::left_hand), "LeftHand");
  EXPECT_EQ(joint_name(skeleton, map, Role::hips), "Hips");
  EXPECT_EQ(joint_name(skeleton, map, Role::chest), "Spine");
}

TEST(Roles, WhatIsNoPersonGetsNone) {
  for (const char* text : {"base .child1 ..child2 ...child3 ....tip!", "only", "Hips .Head",
                           "door .hinge ..handle", "a .b .c .d .e"}) {
    const Skeleton skeleton = skeleton_from_text(text);
    const RoleMap map = find_roles(skeleton);
    EXPECT_FALSE(map.humanoid) << text;
    for (std::size_t j = 0; j < map.roles.size(); ++j) {
      EXPECT_EQ(map.roles[j], skeleton.end_sites[j] != 0 ? Role::end : Role::none) << text;
    }
  }
}

TEST(Roles, AnEmptySkeletonIsNoPerson) {
  const RoleMap map = find_roles({});
  EXPECT_TRUE(map.roles.empty());
  EXPECT_FALSE(map.humanoid);
  EXPECT_EQ(map.joint(Role::hips), -1);
}

TEST(Roles, AVeryLongChainIsNoTrouble) {
  Skeleton skeleton;
  for (int j = 0; j < 100000; ++j) skeleton.add("LeftArm" + std::to_string(j), j - 1, {});
  EXPECT_FALSE(find_roles(skeleton).humanoid);
  Skeleton comb;  // each joint of a chain has a twin
  for (int j = 0; j < 100000; ++j) {
    const int parent = j == 0 ? -1 : (j - 1) / 2 * 2;
    comb.add("n" + std::to_string(j), parent, {Vec3(j % 2, j, 0), Quat::Identity()});
  }
  EXPECT_FALSE(find_roles(comb).humanoid);
}

// A person whose joints have no names that tell anything, y-up, facing +z, left at +x.
Skeleton unnamed_actor(double hands_height) {
  Skeleton s;
  int next = 0;
  const auto add = [&](int parent, double x, double y, double z) {
    return s.add("n" + std::to_string(next++), parent, {Vec3(x, y, z), Quat::Identity()});
  };
  const int hips = add(-1, 0, 1, 0);
  const int chest = add(add(hips, 0, 1.2, 0), 0, 1.4, 0);
  add(add(chest, 0, 1.5, 0), 0, 1.6, 0);
  for (const double side : {-1.0, 1.0}) {
    const int shoulder = add(add(chest, side * 0.05, 1.4, 0), side * 0.2, 1.4, 0);
    add(add(shoulder, side * 0.45, 0.5 * (1.4 + hands_height), 0), side * 0.7, hands_height, 0);
    const int foot =
        add(add(add(hips, side * 0.1, 0.95, 0), side * 0.1, 0.5, 0), side * 0.1, 0.1, 0);
    add(foot, side * 0.1, 0, 0.15);
  }
  return s;
}

TEST(Roles, AnUnnamedPersonIsKnownByShape) {
  const Skeleton skeleton = unnamed_actor(1.4);
  const RoleMap map = find_roles(skeleton);
  ASSERT_TRUE(map.humanoid) << table(skeleton, map);
  const auto place = [&](Role role) {
    return skeleton.reference[static_cast<std::size_t>(map.joint(role))].position;
  };
  EXPECT_GT(place(Role::left_hand).x(), 0.6);
  EXPECT_LT(place(Role::right_hand).x(), -0.6);
  EXPECT_GT(place(Role::left_foot).x(), 0);
  EXPECT_DOUBLE_EQ(place(Role::head).y(), 1.6);
  EXPECT_DOUBLE_EQ(place(Role::left_foot).y(), 0.1);
  EXPECT_GE(map.joint(Role::left_collar), 0);
}

// If this fails, a person some of whose joints are named in a language that is not known has no
// whole body, or a shape overrules what names say.
TEST(Roles, TheShapeFillsInWhereNamesAreKnownInPart) {
  Skeleton skeleton = unnamed_actor(1.4);
  const RoleMap whole = find_roles(skeleton);
  const auto rename = [&](Role role, const char* name) {
    skeleton.names[static_cast<std::size_t>(whole.joint(role))] = name;
  };
  rename(Role::left_upper_arm, "LeftArm");
  rename(Role::left_lower_arm, "LeftForeArm");
  rename(Role::left_hand, "LeftHand");
  EXPECT_EQ(find_roles(skeleton).roles, whole.roles);
  rename(Role::left_upper_arm, "RightArm");
  rename(Role::left_lower_arm, "RightForeArm");
  rename(Role::left_hand, "RightHand");
  const RoleMap contradicted = find_roles(skeleton);
  EXPECT_FALSE(contradicted.humanoid);
  EXPECT_EQ(contradicted.joint(Role::right_hand), whole.joint(Role::left_hand));
}

// A character of games: the body's joints have a prefix, most joints are of hair and clothes. If
// this fails, forearms are taken for hands, for what hangs on them, or tails of hair for arms.
TEST(Roles, HairAndClothesAreNoLimbs) {
  const Skeleton actor = unnamed_actor(1.4);
  const RoleMap bare = find_roles(actor);
  Skeleton dressed = actor;
  const auto hang = [&](Role role, const std::string& name, const Vec3& way, int count) {
    int joint = bare.joint(role);
    Vec3 place = actor.reference[static_cast<std::size_t>(joint)].position;
    for (int i = 0; i < count; ++i) {
      place += way;
      joint = dressed.add(name + std::to_string(i), joint, {place, Quat::Identity()});
    }
  };
  for (const bool left : {true, false}) {
    const double side = left ? 1 : -1;
    const std::string letter = left ? "L_" : "R_";
    hang(Role::head, "J_" + letter + "Tail", {side * 0.04, -0.2, -0.02}, 6);
    hang(left ? Role::left_lower_arm : Role::right_lower_arm, "J_" + letter + "Sleeve",
         {0, -0.08, 0}, 2);
    hang(Role::hips, "J_" + letter + "Skirt", {side * 0.02, -0.2, 0}, 4);
  }
  RoleMap by_shape = find_roles(dressed);
  by_shape.roles.resize(bare.roles.size());
  EXPECT_EQ(by_shape.roles, bare.roles) << table(dressed, by_shape);
  for (const bool left : {true, false}) {
    const ArmRoles& arm = kArmRoles[left ? 0 : 1];
    const LegRoles& leg = kLegRoles[left ? 0 : 1];
    const std::string side = left ? "Hero1_Left" : "Hero1_Right";
    const auto rename = [&](Role role, const char* name) {
      dressed.names[static_cast<std::size_t>(bare.joint(role))] = side + name;
    };
    rename(arm.upper, "Arm");
    rename(arm.lower, "ForeArm");
    rename(arm.hand, "Hand");
    rename(leg.upper, "UpLeg");
    rename(leg.lower, "Leg");
    rename(leg.foot, "Foot");
  }
  const std::vector<JointName> names = read_joint_names(dressed);
  const JointName& hand = names[static_cast<std::size_t>(bare.joint(Role::right_hand))];
  EXPECT_EQ(hand.part, Part::hand);
  EXPECT_EQ(hand.side, Side::right);
}

// An animal on four legs has its "hands" on the ground: sides are not guessed there.
TEST(Roles, AnUnnamedActorWithItsHandsOnTheGroundIsLeftAlone) {
  EXPECT_FALSE(find_roles(unnamed_actor(0.1)).humanoid);
}

TEST(Roles, EveryRoleHasItsName) {
  std::vector<std::string_view> seen;
  for (int r = 0; r <= static_cast<int>(Role::helper); ++r) {
    const std::string_view name = role_name(static_cast<Role>(r));
    EXPECT_FALSE(name.empty());
    EXPECT_EQ(std::count(seen.begin(), seen.end(), name), 0);
    seen.push_back(name);
  }
  EXPECT_EQ(role_name(Role::left_upper_arm), "left_upper_arm");
  EXPECT_EQ(role_name(Role::right_toes), "right_toes");
  EXPECT_EQ(role_name(Role::helper), "helper");
}

}  // namespace
}  // namespace krok
