// If these fail, a user's file that says what joints are is misread, or its faults are told without
// their place.
#include "formats/role_map/role_map.h"

#include <gtest/gtest.h>

#include "core/text.h"
#include "support/human_skeleton.h"

namespace krok {
namespace {

struct Fault {
  const char* name;
  const char* text;
  const char* code;
  int line, column;
  const char* says;  // in the message or the hint
};

class RoleMapFault : public testing::TestWithParam<Fault> {};

TEST_P(RoleMapFault, IsToldWithItsPlace) {
  const Fault& fault = GetParam();
  const auto map = role_map::read(fault.text, "rig.json", test::human_skeleton());
  ASSERT_FALSE(map.ok());
  const Error& error = map.error();
  EXPECT_EQ(error.code, fault.code);
  EXPECT_EQ(error.where.file, "rig.json");
  EXPECT_EQ(error.where.line, fault.line) << error.message;
  EXPECT_EQ(error.where.column, fault.column) << error.message;
  EXPECT_NE((error.message + " " + error.hint).find(fault.says), std::string::npos)
      << error.message << " / " << error.hint;
}

const Fault kFaults[] = {
    {"no_json", "{\"joints\": ]}", "json-syntax", 1, 12, ""},
    {"not_an_object", "[1]", "role-map-shape", 1, 1, "an array"},
    {"no_joints", "{\n}", "role-map-shape", 1, 1, "joints"},
    {"joints_no_object", "{\n \"joints\": 3}", "role-map-shape", 2, 12, "joints"},
    {"other_schema", "{\"schema\": \"krok.role-map/9\", \"joints\": {}}", "role-map-shape", 1, 12,
     "krok.role-map/1"},
    {"unknown_key", "{\"joint\": {}}", "role-map-shape", 1, 2, "\"joint\""},
    {"unknown_joint", "{\"joints\": {\n  \"LeftHnad\": \"left_hand\"}}", "role-map-joint", 2, 3,
     "did you mean \"LeftHand\"?"},
    {"far_joint", "{\"joints\": {\n  \"Propeller\": \"left_hand\"}}", "role-map-joint", 2, 3,
     "krok-info -v"},
    {"swapped", "{\"joints\": {\n  \"left_hand\": \"LeftHand\"}}", "role-map-joint", 2, 3,
     "the joint comes first: \"LeftHand\": \"left_hand\""},
    {"unknown_role", "{\"joints\": {\n  \"LeftHand\": \"left_hnd\"}}", "role-map-role", 2, 15,
     "did you mean \"left_hand\"?"},
    {"unknown_finger", "{\"joints\": {\n  \"LeftHand\": \"left_index_7\"}}", "role-map-role", 2, 15,
     "did you mean \"left_index_1\"?"},
    {"an_end_is_no_role", "{\"joints\": {\"LeftHand\": \"end\"}}", "role-map-role", 1, 25, "end"},
    {"role_no_text", "{\"joints\": {\"LeftHand\": 7}}", "role-map-role", 1, 25, "a number"},
    {"key_twice", "{\"joints\": {\"LeftHand\": \"left_hand\",\n \"LeftHand\": \"none\"}}",
     "json-syntax", 2, 2, "LeftHand"},
    {"role_twice", "{\"joints\": {\"LeftHand\": \"left_hand\",\n \"LeftForeArm\": \"left_hand\"}}",
     "role-twice", 2, 2, "'LeftForeArm'"},
    {"out_of_order",
     "{\"joints\": {\"LeftHand\": \"left_upper_arm\",\n \"LeftArm\": \"left_hand\"}}", "role-order",
     2, 2, "'LeftHand' is left_upper_arm"},
    {"legs_exchanged",
     "{\"joints\": {\"LeftUpLeg\": \"right_upper_leg\", \"RightUpLeg\": \"left_upper_leg\",\n"
     "\"LeftLeg\": \"right_lower_leg\", \"RightLeg\": \"left_lower_leg\", \"LeftFoot\": "
     "\"right_foot\", \"RightFoot\": \"left_foot\", \"LeftToeBase\": \"right_toes\", "
     "\"RightToeBase\": \"left_toes\"}}",
     "role-map-sides", 1, 12, "exchange left and right"}};

INSTANTIATE_TEST_SUITE_P(Faults, RoleMapFault, testing::ValuesIn(kFaults),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(RoleMapFile, GivesRoles) {
  const Skeleton skeleton = test::human_skeleton();
  const auto map = role_map::read(
      "\xEF\xBB\xBF{\"schema\": \"krok.role-map/1\", \"comment\": \"by hand\",\r\n \"joints\": "
      "{\"Spine1\": \"chest\", \"Neck\": \"none\"}}",
      "rig.json", skeleton);
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->joint(Role::chest), skeleton.find("Spine1"));
  EXPECT_EQ(map->joint(Role::neck), -1);
  EXPECT_EQ(map->joint(Role::left_hand), skeleton.find("LeftHand"));
}

TEST(RoleMapFile, AnEmptyOneChangesNothing) {
  const Skeleton skeleton = test::human_skeleton();
  const auto map = role_map::read("{\"joints\": {}}", "rig.json", skeleton);
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->roles, find_roles(skeleton).roles);
}

TEST(NearestName, IsFoundWhateverTheCase) {
  const std::vector<std::string> names = {"LeftHand", "RightHand", "Head"};
  EXPECT_EQ(nearest_name("lefthand", names), "LeftHand");
  EXPECT_EQ(nearest_name("Rihgt_hand", names), "RightHand");
  EXPECT_EQ(nearest_name("Had", names), "Head");
  EXPECT_EQ(nearest_name("Pelvis", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, VeryLongNamesAreNoTrouble) {
  const std::vector<std::string> names(200, std::string(100000, 'a'));
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), names).size(), 100000u);
}

}  // namespace
}  // namespace krok
