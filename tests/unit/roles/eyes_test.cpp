// If this fails, an imported character's eyes are missed, or lids and targets are taken for them.

#include "roles/roles.h"

#include <gtest/gtest.h>

namespace krok {
namespace {

Skeleton with_joints(const std::vector<std::string>& names) {
  Skeleton skeleton;
  int parent = Skeleton::kNoParent;
  for (const std::string& name : names) parent = skeleton.add(name, parent, {});
  return skeleton;
}

TEST(FindEyes, KnowsTheSpellingsOfExporters) {
  for (const auto& [left, right] : {std::pair{"mixamorig:LeftEye", "mixamorig:RightEye"},
                                    {"eye.L", "eye.R"},
                                    {"lEye", "rEye"},
                                    {"J_Adj_L_FaceEye", "J_Adj_R_FaceEye"},
                                    {"CC_Base_L_Eye", "CC_Base_R_Eye"},
                                    {"Eye_Left", "Eye_Right"},
                                    {"eyeball_l", "eyeball_r"}}) {
    const EyeJoints eyes = find_eyes(with_joints({"Hips", "Head", right, left}));
    EXPECT_EQ(eyes.left, 3) << left;
    EXPECT_EQ(eyes.right, 2) << right;
  }
}

TEST(FindEyes, LeavesWhatIsAroundAnEye) {
  const EyeJoints eyes =
      find_eyes(with_joints({"LeftEyeLid", "eyelid_r", "Eye_Brow_L", "LeftEye_End", "eye_target.R",
                             "Eye", "LeftEye", "LeftEye2", "Goggle"}));
  EXPECT_EQ(eyes.left, 6);
  EXPECT_EQ(eyes.right, -1);
  EXPECT_EQ(find_eyes(Skeleton()).left, -1);
}

}  // namespace
}  // namespace krok
