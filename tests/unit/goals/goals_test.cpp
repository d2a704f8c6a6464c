// If these fail, goals are sought that the file does not ask for, or a mistake in a file is passed
// over or reported at the wrong place.

#include "formats/goals/goals.h"

#include <gtest/gtest.h>

#include <random>

#include "core/index.h"
#include "support/test_scenes.h"
#include "support/told_mistakes.h"

namespace krok::goals {
namespace {

constexpr const char* kGood = R"({
  "schema": "krok.goals/1",
  "length_unit": "cm",
  "rate": 50,
  "root_moves": true,
  "stiffness": {"Spine": 0.7},
  "goals": [
    {"name": "rail", "joint": "RightHand", "point": [1, 2, 3],
     "keys": [{"time": "500ms", "target": [-40, 100, 30]},
              {"time": "100f", "target": [-40, 100, 110], "easing": "linear"}],
     "fade_in": "200ms", "fade": "sine", "weight": 2, "depth": 4},
    {"kind": "pole", "joint": "right_lower_arm", "upper": "RightArm", "lower": "RightHand",
     "keys": [{"time": 1.5, "target": [0, 1, 0]}], "to": 2.5},
    {"kind": "look-at", "joint": "head", "axis": [0, 0, 2], "keys": [{"time": 0, "target": [0, 1, 5]}]},
    {"kind": "pose", "joint": "LeftHand", "relative_to": "hips",
     "keys": [{"time": 0, "target": [0, 0, 0], "orientation": [0, 0.6, 0, 0.8]}], "from": 0, "to": 4},
    {"kind": "orientation", "joint": "Head", "motion": "other.anim", "relative_to": "LeftHand",
     "keys": [{"time": 0, "orientation": [0, 0, 0, 1]}]},
    {"kind": "balance", "support": ["LeftFoot", "right_foot"]}
  ]
})";

Result<GoalFile> read_for(const std::string& text) {
  static const Skeleton skeleton = test::turned_human();
  static const RoleMap roles = find_roles(skeleton);
  return read(text, skeleton, roles);
}

TEST(Goals, ReadsWhatTheSpecSays) {
  const Skeleton skeleton = test::turned_human();
  const auto file = read_for(kGood);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_TRUE(file->root_moves);
  EXPECT_EQ(file->stiffness[at(skeleton.find("Spine"))], 0.7);
  ASSERT_EQ(file->goals.size(), 6u);
  const ik::KeyedGoal& rail = file->goals[0];
  EXPECT_EQ(rail.name, "rail");
  EXPECT_EQ(rail.goal.joint, skeleton.find("RightHand"));
  EXPECT_EQ(rail.goal.kind, ik::Goal::Kind::position);
  EXPECT_LT((rail.goal.point - Vec3(0.01, 0.02, 0.03)).norm(), 1e-12);
  ASSERT_EQ(rail.keys.size(), 2u);
  EXPECT_EQ(rail.keys[0].time, 0.5);
  EXPECT_EQ(rail.keys[1].time, 2.0);
  EXPECT_LT((rail.keys[1].target - Vec3(-0.4, 1, 1.1)).norm(), 1e-12);
  EXPECT_EQ(rail.keys[1].easing.curve, timeline::Curve::linear);
  EXPECT_EQ(rail.keys[0].easing.curve, timeline::Curve::smooth);
  EXPECT_EQ(rail.fade_in, 0.2);
  EXPECT_EQ(rail.fade_out, 0.3);
  EXPECT_EQ(rail.fade.curve, timeline::Curve::sine);
  EXPECT_EQ(rail.goal.weight, 2);
  EXPECT_EQ(rail.goal.depth, 4);
  const ik::KeyedGoal& pole = file->goals[1];
  EXPECT_EQ(pole.goal.upper, skeleton.find("RightArm"));
  EXPECT_EQ(pole.goal.lower, skeleton.find("RightHand"));
  EXPECT_EQ(pole.to, 2.5);
  EXPECT_FALSE(pole.from.has_value());
  // From the head up to, but without, the hips: head, neck, three joints of the spine.
  EXPECT_EQ(file->goals[2].goal.depth, 5);
  EXPECT_EQ(file->goals[2].goal.axis, Vec3(0, 0, 1));
  EXPECT_EQ(file->goals[3].relative_to, skeleton.find("Hips"));
  EXPECT_NEAR(file->goals[3].keys[0].orientation.y(), 0.6, 1e-12);
  ASSERT_EQ(file->others.size(), 1u);
  EXPECT_EQ(file->others[0].goal, 4u);
  EXPECT_EQ(file->others[0].path, "other.anim");
  EXPECT_EQ(file->others[0].where.line, 17);
  EXPECT_EQ(file->goals[5].support_joints.size(), 2u);
  EXPECT_EQ(file->goals[5].goal.depth, 0);
}

// What faces forwards in the reference pose looks, whatever the joint's own axes are.
TEST(Goals, ARoleIsFoundHoweverItIsWritten) {
  const Skeleton skeleton = test::turned_human();
  const RoleMap roles = find_roles(skeleton);
  const int arm = skeleton.find("RightForeArm");
  ASSERT_GE(arm, 0);
  for (const char* name :
       {"right_lower_arm", "RightLowerArm", "Right_Lower_Arm", "rightlowerarm", "right elbow"}) {
    EXPECT_EQ(find_joint(skeleton, roles, name), arm) << name;
  }
  for (const char* name : {"", "none", "RIGHT", "Right_", "LowerArm", "elbow"}) {
    EXPECT_EQ(find_joint(skeleton, roles, name), -1) << name;
  }
}

TEST(Goals, AJointLooksWhereItFacesUnlessToldOtherwise) {
  const Skeleton skeleton = test::turned_human();
  const auto file = read_for(test::replaced(kGood, "\"axis\": [0, 0, 2], ", ""));
  ASSERT_TRUE(file.ok());
  const ik::Goal& look = file->goals[2].goal;
  EXPECT_LT((skeleton.reference[at(look.joint)].orientation * look.axis - Vec3::UnitZ()).norm(),
            1e-12);
}

TEST(Goals, MistakesAreToldWithTheirPlace) {
  const test::Mistake mistakes[] = {
      {"krok.goals/1", "krok.steps/1", "goals-structure 2:13"},
      {"\"cm\"", "\"yards\"", "goals-value 3:18", "ft"},
      {"\"rate\": 50", "\"rate\": 0", "goals-value 4:11"},
      {"\"rate\": 50,", "", "goals-value 10:24", "rate"},
      {"0.7", "1.7", "goals-value 6:26"},
      {"\"Spine\"", "\"Spin\"", "goals-joint 6:17", "Spine"},
      {"\"RightHand\", \"point\"", "\"RightHan\", \"point\"", "goals-joint 8:31", "RightHand"},
      {"[1, 2, 3]", "[1, 2]", "goals-value 8:53", "3 numbers"},
      {"[1, 2, 3]", "[1, 2, 1e12]", "goals-value 8:53"},
      {"\"500ms\"", "\"500 parsecs\"", "goals-value 9:24"},
      {"\"100f\"", "\"10f\"", "goals-time 10:24", "not after"},
      {"\"linear\"", "\"liner\"", "goals-value 10:69", "linear"},
      {"\"sine\"", "\"wave\"", "goals-value 11:34"},
      {"\"weight\": 2", "\"weight\": 0", "goals-value 11:52"},
      {"\"depth\": 4", "\"depth\": 0.5", "goals-value 11:64", "whole"},
      {"\"pole\"", "\"pool\"", "goals-value 12:14", "pole"},
      {"\"to\": 2.5", "\"too\": 2.5", "goals-structure 13:52", "to"},
      {"[0, 0, 2]", "[0, 0, 0]", "goals-value 14:50", "length"},
      {", \"orientation\": [0, 0.6, 0, 0.8]", "", "goals-structure 16:15", "orientation"},
      {"[0, 0.6, 0, 0.8]", "[0, 6, 0, 8]", "goals-value 16:63", "length 10"},
      {"\"from\": 0, \"to\": 4", "\"from\": 5, \"to\": 4", "goals-time 16:100", "before"},
      {"other.anim", "../other.anim", "goals-path 17:56"},
      {", \"relative_to\": \"LeftHand\"", "", "goals-structure 17:5", "relative_to"},
      {"[{\"time\": 0, \"orientation\": [0, 0, 0, 1]}]", "[]", "goals-structure 17:5", "keys"},
      {"[\"LeftFoot\", \"right_foot\"]", "[]", "goals-value 19:36", "empty"},
      {"[\"LeftFoot\", \"right_foot\"]", "[3]", "goals-value 19:37"}};
  test::expect_told(kGood, mistakes, read_for);
}

TEST(Goals, DamagedTextsNeverGiveGoalsThatMeanNothing) {
  std::mt19937 random(4);
  const Skeleton skeleton = test::turned_human();
  const Clip clip = test::swinging_clip(skeleton, 2, 50);
  int read_well = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = test::damaged(kGood, random);
    const auto file = read_for(text);
    if (!file.ok()) {
      EXPECT_GT(file.error().where.line, 0);
      continue;
    }
    ++read_well;
    // What was read can be brought about, or is refused for what it is.
    if (read_well > 40) continue;
    std::vector<ik::KeyedGoal> goals = file->goals;
    goals.erase(goals.begin() + 4);
    const auto made = ik::apply_goals(clip, goals, {});
    if (!made.ok()) {
      EXPECT_EQ(made.error().code, "ik-goal") << text;
      continue;
    }
    EXPECT_TRUE(check(made->clip).ok());
  }
  EXPECT_GT(read_well, 50);
}

}  // namespace
}  // namespace krok::goals
