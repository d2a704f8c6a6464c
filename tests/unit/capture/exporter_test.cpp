// If these fail, a user is told a wrong exporter, or iPi's files are not recognised.
#include "capture/convention_choice.h"

#include <gtest/gtest.h>

#include <sstream>

namespace krok {
namespace {

Skeleton with_joints(const std::string& names) {
  Skeleton skeleton;
  std::istringstream words(names);
  for (std::string word; words >> word;) {
    skeleton.add(word, static_cast<int>(skeleton.names.size()) - 1, {});
  }
  return skeleton;
}

std::string exporter_of(const std::string& names, const ExporterTraits& traits = {}) {
  const auto found = recognise_exporter(with_joints(names), traits);
  return found ? found->name : "";
}

const std::string kMotionBuilder =
    "Hips Spine LeftUpLeg LeftLeg LeftFoot RightUpLeg RightLeg RightFoot LeftShoulder LeftArm "
    "LeftForeArm LeftHand RightShoulder RightArm RightForeArm RightHand Neck Head";

TEST(Exporter, IpiIsRecognisedByItsOwnNames) {
  const std::string names =
      "Hip LowerSpine MiddleSpine Chest Neck Head LClavicle LShoulder LForearm LHand LThigh LShin "
      "LFoot LToe";
  const auto found = recognise_exporter(with_joints(names), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->name, "iPi Mocap Studio, own names");
  EXPECT_EQ(found->confidence, Confidence::certain);
  ExporterTraits traits;
  traits.frame_time = "0.0333333000";
  traits.rows_begin_with_tab = true;
  EXPECT_NE(recognise_exporter(with_joints(names), traits)->reason.find("printed"),
            std::string::npos);
}

TEST(Exporter, IpisSecondPresetIsToldFromMotionBuilderByHowItIsWritten) {
  ExporterTraits traits;
  EXPECT_EQ(exporter_of(kMotionBuilder, traits), "MotionBuilder's names");
  traits.starts_unturned = true;
  EXPECT_EQ(recognise_exporter(with_joints(kMotionBuilder), traits)->confidence, Confidence::guess);
  EXPECT_EQ(exporter_of(kMotionBuilder, traits),
            "MotionBuilder's names with a rest pose as frame 0");
  traits.rows_begin_with_tab = true;
  traits.frame_time = "0.0333333";
  EXPECT_EQ(exporter_of(kMotionBuilder, traits),
            "MotionBuilder's names with a rest pose as frame 0");
  traits.frame_time = "0.0333333000";
  EXPECT_EQ(exporter_of(kMotionBuilder, traits),
            "iPi Mocap Studio, MotionBuilder's names with a rest pose as frame 0");
}

TEST(Exporter, NamesAreComparedWithoutCaseAndNameSpaces) {
  std::string names;
  std::istringstream words(kMotionBuilder);
  for (std::string word; words >> word;) names += "Actor:rig:" + word + " ";
  EXPECT_EQ(exporter_of(names), "MotionBuilder's names");
  EXPECT_EQ(exporter_of("PELVIS SPINE_01 UPPERARM_L LOWERARM_L THIGH_L CALF_L"),
            "Unreal Engine's skeleton");
  Skeleton biped = with_joints("Bip01");
  for (const char* name : {"Bip01 L Thigh", "Bip01 L Calf", "Bip01 L UpperArm"}) {
    biped.add(name, 0, {});
  }
  EXPECT_EQ(recognise_exporter(biped, {})->name, "3ds Max Biped");
}

TEST(Exporter, MixamoIsKnownByItsPrefix) {
  std::string names;
  std::istringstream words(kMotionBuilder);
  for (std::string word; words >> word;) names += "mixamorig:" + word + " ";
  EXPECT_EQ(exporter_of(names), "Mixamo");
}

TEST(Exporter, MoreTellingNamesComeBeforeMotionBuilders) {
  EXPECT_EQ(exporter_of(kMotionBuilder + " LHipJoint RHipJoint LowerBack LThumb"),
            "a conversion of the CMU collection");
  EXPECT_EQ(exporter_of(kMotionBuilder + " LeftInHandIndex RightInHandIndex"),
            "Perception Neuron, or another with its names");
}

// Axes of an exporter replace guesses from a take (one that lies, say), never what a converted file
// clearly shows.
TEST(Exporter, ItsAxesReplaceGuesses) {
  const Exporter known = *recognise_exporter(
      with_joints("joint_Root Hips UpperLeg_L LowerLeg_L Toes_L UpperArm_L"), {});
  ASSERT_TRUE(known.up && known.forward);
  Conventions lying;
  lying.up = Direction::plus_z;
  lying.forward = Direction::minus_y;
  lying.up_confidence = Confidence::likely;
  Conventions converted = lying;
  converted.up_confidence = converted.forward_confidence = Confidence::certain;
  apply_exporter(known, lying);
  EXPECT_EQ(lying.up, Direction::plus_y);
  EXPECT_EQ(lying.forward, Direction::plus_z);
  EXPECT_EQ(lying.forward_confidence, Confidence::likely);
  EXPECT_EQ(lying.up_confidence, Confidence::guess);  // what the take shows is another axis
  apply_exporter(known, converted);
  EXPECT_EQ(converted.up, Direction::plus_z);
  EXPECT_EQ(converted.forward, Direction::minus_y);
  Conventions facing_x;
  facing_x.up_confidence = facing_x.forward_confidence = Confidence::likely;
  facing_x.forward = Direction::plus_x;
  apply_exporter(known, facing_x);
  EXPECT_EQ(facing_x.forward, Direction::plus_x);
}

TEST(Exporter, UnknownNamesAreNobodys) {
  EXPECT_EQ(exporter_of(""), "");
  EXPECT_EQ(exporter_of("a b c"), "");
  EXPECT_EQ(exporter_of("Hip LowerSpine MiddleSpine Chest"), "");
}

}  // namespace
}  // namespace krok
