// If these fail, fingers of a well-known exporter are taken for one another, and retargeting bends
// the wrong ones.
#include "roles/fingers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "roles/roles.h"
#include "support/skeleton_text.h"

namespace krok {
namespace {

using test::skeleton_from_text;

struct HandNames {
  const char* exporter;
  const char* joints;  // beyond the wrist of the left hand, a dot a level
  const char* places;  // in the same order, "-" for none
};

// The joints of one arm, then of one hand, in a whole body that tells it from other things.
Skeleton body_with_hand(const std::string& hand_joints) {
  std::string text =
      "Hips .Spine ..Neck ...Head ..LeftShoulder ...LeftArm ....LeftForeArm "
      ".....LeftHand ";
  std::istringstream words(hand_joints);
  for (std::string word; words >> word;) text += "......" + word + " ";
  text +=
      "..RightShoulder ...RightArm ....RightForeArm .....RightHand .LeftUpLeg ..LeftLeg "
      "...LeftFoot .RightUpLeg ..RightLeg ...RightFoot";
  return skeleton_from_text(text);
}

std::string place_of(const RoleMap& map, int joint) {
  const std::string label = role_label(map, joint);
  if (label == "left_fingers") return "-";
  return label.starts_with("left_") ? label.substr(5) : label;
}

class FingerNames : public testing::TestWithParam<HandNames> {};

TEST_P(FingerNames, AreKnown) {
  const Skeleton skeleton = body_with_hand(GetParam().joints);
  ASSERT_TRUE(check(skeleton).ok());
  const RoleMap map = find_roles(skeleton);
  std::istringstream places(GetParam().places);
  for (int joint = skeleton.find("LeftHand") + 1; joint < skeleton.find("RightShoulder"); ++joint) {
    std::string expected;
    ASSERT_TRUE(places >> expected);
    EXPECT_EQ(place_of(map, joint), expected) << skeleton.names[static_cast<std::size_t>(joint)];
  }
  std::string more;
  EXPECT_FALSE(places >> more);
}

const HandNames kHands[] = {
    {"ipi",
     "LFinger1 .LFinger11 ..LFinger12 LFinger2 .LFinger21 ..LFinger22 LFinger3 .LFinger31 "
     "..LFinger32 LFinger4 .LFinger41 ..LFinger42 LFinger0 .LFinger01 ..LFinger02",
     "index_1 index_2 index_3 middle_1 middle_2 middle_3 ring_1 ring_2 ring_3 little_1 little_2 "
     "little_3 thumb_1 thumb_2 thumb_3"},
    {"motionbuilder",
     "LeftHandThumb1 .LeftHandThumb2 ..LeftHandThumb3 ...LeftHandThumb4 LeftInHandIndex "
     ".LeftHandIndex1 ..LeftHandIndex2 ...LeftHandIndex3 ....LeftHandIndex4 LeftHandPinky1 "
     ".LeftHandPinky2",
     "thumb_1 thumb_2 thumb_3 thumb_tip index_metacarpal index_1 index_2 index_3 index_tip "
     "little_1 little_2"},
    {"mixamo",
     "mixamorig:LeftHandMiddle1 .mixamorig:LeftHandMiddle2 mixamorig:LeftHandThumb1 "
     "mixamorig:LeftHandRing1 mixamorig:LeftHandPinky1 mixamorig:LeftHandIndex1",
     "middle_1 middle_2 thumb_1 ring_1 little_1 index_1"},
    {"cmu", "LeftFingerBase .LFingers LThumb", "- all_1 thumb_1"},
    {"cmu_with_index", "LeftFingerBase .LeftHandIndex1 LThumb", "- index_1 thumb_1"},
    {"acclaim", "lfingers lthumb", "all_1 thumb_1"},
    {"rokoko",
     "LeftFinger1Metacarpal .LeftFinger1Proximal ..LeftFinger1Distal ...LeftFinger1Tip "
     "LeftFinger2Metacarpal .LeftFinger2Proximal ..LeftFinger2Medial ...LeftFinger2Distal "
     "....LeftFinger2Tip LeftFinger5Metacarpal .LeftFinger5Proximal",
     "thumb_1 thumb_2 thumb_3 thumb_tip index_metacarpal index_1 index_2 index_3 index_tip "
     "little_metacarpal little_1"},
    {"xsens",
     "LeftCarpus .LeftFirstMC ..LeftFirstPP ...LeftFirstDP .LeftSecondMC ..LeftSecondPP "
     "...LeftSecondMP ....LeftSecondDP .LeftThirdMC ..LeftThirdPP .LeftFourthMC ..LeftFourthPP "
     ".LeftFifthMC ..LeftFifthPP",
     "- thumb_1 thumb_2 thumb_3 index_metacarpal index_1 index_2 index_3 middle_metacarpal "
     "middle_1 ring_metacarpal ring_1 little_metacarpal little_1"},
    {"optitrack",
     "Skeleton1_LThumb1 .Skeleton1_LThumb2 ..Skeleton1_LThumb3 Skeleton1_LIndex1 "
     ".Skeleton1_LIndex2 Skeleton1_LMiddle1 Skeleton1_LRing1 Skeleton1_LPinky1",
     "thumb_1 thumb_2 thumb_3 index_1 index_2 middle_1 ring_1 little_1"},
    {"perception_neuron",
     "Robot_LeftHandThumb1 Robot_LeftInHandMiddle .Robot_LeftHandMiddle1 ..Robot_LeftHandMiddle2",
     "thumb_1 middle_metacarpal middle_1 middle_2"},
    {"daz_genesis_3",
     "lCarpal1 .lIndex1 ..lIndex2 ...lIndex3 lCarpal2 .lMid1 lCarpal3 .lRing1 lCarpal4 .lPinky1 "
     "lThumb1 .lThumb2",
     "index_metacarpal index_1 index_2 index_3 middle_metacarpal middle_1 ring_metacarpal ring_1 "
     "little_metacarpal little_1 thumb_1 thumb_2"},
    {"daz_genesis_2", "lCarpal1 .lIndex1 .lMid1 lCarpal2 .lRing1 .lPinky1",
     "- index_1 middle_1 - ring_1 little_1"},
    {"iclone",
     "CC_Base_L_Mid1 .CC_Base_L_Mid2 CC_Base_L_Index1 CC_Base_L_Ring1 CC_Base_L_Pinky1 "
     "CC_Base_L_Thumb1",
     "middle_1 middle_2 index_1 ring_1 little_1 thumb_1"},
    {"poser", "lThumb1 .lThumb2 lIndex1 .lIndex2 lMid1 lRing1 lPinky1",
     "thumb_1 thumb_2 index_1 index_2 middle_1 ring_1 little_1"},
    {"second_life",
     "mHandThumb1Left .mHandThumb2Left mHandIndex1Left mHandMiddle1Left mHandRing1Left "
     "mHandPinky1Left",
     "thumb_1 thumb_2 index_1 middle_1 ring_1 little_1"},
    {"makehuman",
     "finger1-1.L .finger1-2.L ..finger1-3.L metacarpal4.L .finger5-1.L ..finger5-2.L "
     "metacarpal1.L .finger2-1.L metacarpal2.L .finger3-1.L",
     "thumb_1 thumb_2 thumb_3 little_metacarpal little_1 little_2 index_metacarpal index_1 "
     "middle_metacarpal middle_1"},
    {"makehuman_old",
     "__Thumb1_L .Thumb1_L ..Thumb2_L ...Thumb3_L __Index1_L .Index1_L ..Index2_L Middle1_L",
     "thumb_metacarpal thumb_1 thumb_2 thumb_3 index_metacarpal index_1 index_2 middle_1"},
    {"biped", "Bip01_L_Finger0 .Bip01_L_Finger01 ..Bip01_L_Finger02 Bip01_L_Finger1",
     "thumb_1 thumb_2 thumb_3 index_1"},
    {"unreal",
     "thumb_01_l .thumb_02_l index_metacarpal_l .index_01_l ..index_02_l ...index_03_l pinky_01_l",
     "thumb_1 thumb_2 index_metacarpal index_1 index_2 index_3 little_1"},
    {"vrm",
     "leftThumbMetacarpal .leftThumbProximal ..leftThumbDistal leftIndexProximal "
     ".leftIndexIntermediate ..leftIndexDistal leftLittleProximal",
     "thumb_1 thumb_2 thumb_3 index_1 index_2 index_3 little_1"},
    {"unnumbered_palm", "LeftHandRing .LeftHandRing1 ..LeftHandRing2 LeftHandMiddle1",
     "ring_metacarpal ring_1 ring_2 middle_1"},
    {"fingers_beside_a_thumb", "LThumb1 LFinger1 .LFinger1b LFinger2 LFinger3 LFinger4",
     "thumb_1 index_1 index_2 middle_1 ring_1 little_1"},
    {"no_fingers", "LeftHandEnd LeftHandProp", "- helper"}};

INSTANTIATE_TEST_SUITE_P(Exporters, FingerNames, testing::ValuesIn(kHands),
                         [](const auto& test_case) {
                           return std::string(test_case.param.exporter);
                         });

TEST(Fingers, PlacesHaveNames) {
  EXPECT_EQ(finger_place_name({Finger::index, 2}), "index_2");
  EXPECT_EQ(finger_place_name({Finger::thumb, FingerJoint::kTip}), "thumb_tip");
  EXPECT_EQ(finger_place_name({}), "");
  for (int f = 1; f <= static_cast<int>(Finger::all); ++f) {
    for (int phalanx = 0; phalanx <= FingerJoint::kTip; ++phalanx) {
      const FingerJoint place{static_cast<Finger>(f), phalanx};
      EXPECT_EQ(parse_finger_joint(finger_place_name(place)), place);
    }
  }
  for (const char* text : {"", "index", "index_5", "index_01", "Index_1", "toe_1"}) {
    EXPECT_FALSE(parse_finger_joint(text).has_value()) << text;
  }
}

TEST(Fingers, AHandWithVeryManyJointsIsNoTrouble) {
  std::string text;
  for (int i = 0; i < 20000; ++i)
    text += (i % 2 == 0 ? "LIndex" : ".LIndex") + std::to_string(i) + " ";
  EXPECT_GT(find_roles(body_with_hand(text)).joints(Role::left_fingers).size(), 19000u);
}

}  // namespace
}  // namespace krok
