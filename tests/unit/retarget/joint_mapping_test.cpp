// If these fail, joints take their rotation from the wrong ones: fingers from their neighbours,
// spines from the wrong height, hands from the wrist alone.
#include "retarget/joint_mapping.h"

#include <gtest/gtest.h>

#include "support/skeleton_text.h"
#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using test::at;
using test::skeleton_from_text;

// A body whose left hand has these joints, a dot a level.
Skeleton body_with_hand(const std::string& hand) {
  return skeleton_from_text(
      "Hips .Spine ..Neck ...Head ..LeftShoulder ...LeftArm ....LeftForeArm .....LeftHand " + hand +
      " ..RightShoulder ...RightArm ....RightForeArm .....RightHand .LeftUpLeg ..LeftLeg "
      "...LeftFoot .RightUpLeg ..RightLeg ...RightFoot");
}

// The name of the joint that `joint` of the second takes its rotation from.
std::string source_of(const Skeleton& source, const Skeleton& target, const std::string& joint,
                      bool without_fingers = false) {
  const auto mapping = retarget::map_by_roles(source, find_roles(source), target,
                                              find_roles(target), without_fingers, without_fingers);
  const int from = mapping[at(target.find(joint))].first;
  return from < 0 ? "-" : source.names[at(from)];
}

const char* const kWholeHand =
    "......LeftHandThumb1 .......LeftHandThumb2 ......LeftHandIndex1 .......LeftHandIndex2 "
    "......LeftHandMiddle1 .......LeftHandMiddle2 ......LeftHandRing1 .......LeftHandRing2 "
    "......LeftHandPinky1 .......LeftHandPinky2 ........LeftHandPinky3";

TEST(JointMapping, FingersGoByFingerAndPhalanx) {
  const Skeleton source = body_with_hand(
      "......LFinger1 .......LFinger11 ......LFinger4 .......LFinger41 ......LFinger0");
  const Skeleton target = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(source, target, "LeftHandThumb1"), "LFinger0");
  EXPECT_EQ(source_of(source, target, "LeftHandThumb2"), "-");
  EXPECT_EQ(source_of(source, target, "LeftHandIndex1"), "LFinger1");
  EXPECT_EQ(source_of(source, target, "LeftHandIndex2"), "LFinger11");
  EXPECT_EQ(source_of(source, target, "LeftHandPinky2"), "LFinger41");
  EXPECT_EQ(source_of(source, target, "LeftHandPinky3"), "-");
}

TEST(JointMapping, AFingerThatIsMissingBendsAsItsNeighbour) {
  const Skeleton source = body_with_hand(
      "......LFinger1 .......LFinger11 ......LFinger4 .......LFinger41 ......LFinger0");
  const Skeleton target = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(source, target, "LeftHandMiddle2"), "LFinger11");
  EXPECT_EQ(source_of(source, target, "LeftHandRing1"), "LFinger4");
}

TEST(JointMapping, AThumbIsNoNeighbour) {
  const Skeleton thumb = body_with_hand("......LeftHandThumb1");
  const Skeleton index = body_with_hand("......LeftHandIndex1");
  const Skeleton target = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(thumb, target, "LeftHandIndex1"), "-");
  EXPECT_EQ(source_of(index, target, "LeftHandThumb1"), "-");
  EXPECT_EQ(source_of(index, target, "LeftHandRing1"), "LeftHandIndex1");
}

TEST(JointMapping, OneJointForAllFingersMovesAll) {
  const Skeleton source = body_with_hand("......LeftFingerBase .......LFingers ......LThumb");
  const Skeleton target = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(source, target, "LeftHandRing1"), "LFingers");
  EXPECT_EQ(source_of(source, target, "LeftHandRing2"), "-");
  EXPECT_EQ(source_of(source, target, "LeftHandThumb1"), "LThumb");
  EXPECT_EQ(source_of(target, source, "LFingers"), "LeftHandMiddle1");
}

TEST(JointMapping, APalmBelowTheWristTurnsTheHand) {
  const Skeleton source = body_with_hand("......LeftFingerBase .......LFingers ......LThumb");
  const Skeleton target = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(source, target, "LeftHand"), "LeftFingerBase");
  EXPECT_EQ(source_of(target, source, "LeftFingerBase"), "LeftHand");
}

TEST(JointMapping, FingersCanBeLeftOut) {
  const Skeleton body = body_with_hand(kWholeHand);
  EXPECT_EQ(source_of(body, body, "LeftHandIndex1", true), "-");
  EXPECT_EQ(source_of(body, body, "LeftHand", true), "LeftHand");
}

TEST(JointMapping, SpinesAreSpreadByTheirLength) {
  const Skeleton source = test::human_skeleton();  // spine at 0, 0.26 and 0.68 of the way, 1
  Skeleton target = test::human_skeleton();
  target.names[at(target.find("Spine1"))] = "TwistOfTheBack";  // a helper
  const auto mapping =
      retarget::map_by_roles(source, find_roles(source), target, find_roles(target), false, false);
  const auto& spine = mapping[at(target.find("Spine"))];
  EXPECT_EQ(spine.first, source.find("Spine"));
  EXPECT_NEAR(spine.share, 0, 1e-6);
  EXPECT_NEAR(spine.along, 0.05 / 0.19, 1e-6);
  EXPECT_EQ(mapping[at(target.find("Spine2"))].first, source.find("Spine2"));
  EXPECT_EQ(mapping[at(target.find("TwistOfTheBack"))].first, -1);
}

// Acclaim skeletons have such joints between hips and thighs, which turn by 10 degrees; rigs have
// twists in the chain of an arm. If this fails, their motion is lost as soon as anything else
// differs between the skeletons, or a joint is moved that is another's in truth.
TEST(JointMapping, JointsBetweenMappedOnesGoByName) {
  const auto body = [](const std::string& hip, const std::string& arm) {
    return skeleton_from_text(
        "Hips .Spine ..Neck ...Head ..LeftShoulder ...LeftArm " + arm +
        " .....LeftForeArm ......LeftHand ..RightShoulder ...RightArm ....RightForeArm "
        ".....RightHand ." +
        hip +
        " ..LeftUpLeg ...LeftLeg ....LeftFoot .RightUpLeg ..RightLeg "
        "...RightFoot");
  };
  const Skeleton source = body("LHipJoint ..LBelt", "....LeftArmTwist");
  Skeleton target = body("LHipJoint ..LBelt", "....LeftArmTwist");
  target.names[0] = "Pelvis";
  EXPECT_EQ(source_of(source, target, "LHipJoint"), "LHipJoint");
  EXPECT_EQ(source_of(source, target, "LeftArmTwist"), "LeftArmTwist");
  EXPECT_EQ(source_of(source, target, "LBelt"), "-");  // leads nowhere
  EXPECT_EQ(source_of(source, body("LHip", "....LArmTwist"), "LHip"), "-");
  Skeleton turned = target;
  turned.reference[at(turned.find("LHipJoint"))].orientation =
      from_rotation_vector(Vec3(0.1, 0, 0));
  EXPECT_EQ(source_of(source, turned, "LHipJoint"), "-");
}

TEST(JointMapping, NamesLeaveEndSitesOut) {
  const Skeleton skeleton = skeleton_from_text("a .b ..c ...end!");
  const auto mapping = retarget::map_by_names(skeleton, skeleton);
  EXPECT_EQ(mapping[2].first, 2);
  EXPECT_EQ(mapping[3].first, -1);
}

}  // namespace
}  // namespace krok
