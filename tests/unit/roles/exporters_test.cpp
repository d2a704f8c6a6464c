// If these fail, limbs of captures of a well-known exporter are mistaken or not found, and with
// them everything that works on limbs: bodies, retargeting, inverse kinematics.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "roles/roles.h"
#include "support/skeleton_text.h"
#include "unit/roles/role_text.h"

namespace krok {
namespace {

using test::joint_name;
using test::skeleton_from_text;
using test::table;

// The joint of each role, "left_hand=LHand"; roles that are not named must be absent, except those
// of the right side, which must mirror the left, and end sites and helpers.
struct Scheme {
  const char* exporter;
  const char* joints;
  const char* roles;
};

constexpr Role kLeftRoles[] = {Role::left_collar,    Role::left_upper_arm, Role::left_lower_arm,
                               Role::left_hand,      Role::left_fingers,   Role::left_upper_leg,
                               Role::left_lower_leg, Role::left_foot,      Role::left_toes};
constexpr Role kMiddleRoles[] = {Role::root,  Role::hips, Role::spine,
                                 Role::chest, Role::neck, Role::head};

class RoleSchemes : public testing::TestWithParam<Scheme> {};

TEST_P(RoleSchemes, AreKnown) {
  const Scheme& scheme = GetParam();
  const Skeleton skeleton = skeleton_from_text(scheme.joints);
  ASSERT_TRUE(check(skeleton).ok());
  const RoleMap map = find_roles(skeleton);
  EXPECT_TRUE(map.humanoid) << table(skeleton, map);
  std::map<std::string, std::string> expected;
  std::istringstream words(scheme.roles);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    expected[word.substr(0, equals)] = word.substr(equals + 1);
  }
  const auto hold = [&](std::span<const Role> roles) {
    for (const Role role : roles) {
      const auto found = expected.find(std::string(role_name(role)));
      EXPECT_EQ(joint_name(skeleton, map, role), found == expected.end() ? "-" : found->second)
          << role_name(role) << "\n"
          << table(skeleton, map);
      if (found != expected.end()) expected.erase(found);
    }
  };
  hold(kLeftRoles);
  hold(kMiddleRoles);
  EXPECT_TRUE(expected.empty()) << "the test names a role that there is not";
  // The right side has as many joints of each role as the left.
  for (const Role left : kLeftRoles) {
    const auto right =
        static_cast<Role>(static_cast<int>(left) + (left >= Role::left_upper_leg ? 4 : 5));
    EXPECT_EQ(std::count(map.roles.begin(), map.roles.end(), left),
              std::count(map.roles.begin(), map.roles.end(), right))
        << role_name(left) << "\n"
        << table(skeleton, map);
  }
}

const Scheme kSchemes[] = {
    {"ipi",
     "Hip .LowerSpine ..MiddleSpine ...Chest ....Neck .....Head ......Head_end! "
     "....LClavicle .....LShoulder ......LForearm .......LHand ........LFinger1 .........LFinger11 "
     "........LFinger0 ....RClavicle .....RShoulder ......RForearm .......RHand ........RFinger1 "
     ".........RFinger11 ........RFinger0 .RThigh ..RShin ...RFoot ....RToe .LThigh ..LShin "
     "...LFoot "
     "....LToe",
     "hips=Hip spine=LowerSpine chest=Chest neck=Neck head=Head left_collar=LClavicle "
     "left_upper_arm=LShoulder left_lower_arm=LForearm left_hand=LHand left_fingers=LFinger1 "
     "left_upper_leg=LThigh left_lower_leg=LShin left_foot=LFoot left_toes=LToe"},
    {"motionbuilder",
     "Hips .LeftUpLeg ..LeftLeg ...LeftFoot ....LeftToeBase .RightUpLeg ..RightLeg ...RightFoot "
     "....RightToeBase .Spine ..Spine1 ...LeftShoulder ....LeftArm .....LeftForeArm ......LeftHand "
     ".......LeftHandThumb1 ...RightShoulder ....RightArm .....RightForeArm ......RightHand "
     ".......RightHandThumb1 ...Neck ....Head",
     "hips=Hips spine=Spine chest=Spine1 neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_fingers=LeftHandThumb1 left_upper_leg=LeftUpLeg left_lower_leg=LeftLeg "
     "left_foot=LeftFoot left_toes=LeftToeBase"},
    {"motionbuilder_with_rolls",
     "Reference .Hips ..LeftUpLeg ...LeftUpLegRoll ...LeftLeg ....LeftLegRoll ....LeftFoot "
     "..RightUpLeg ...RightUpLegRoll ...RightLeg ....RightLegRoll ....RightFoot ..Spine "
     "...LeftShoulder ....LeftArm .....LeftArmRoll .....LeftForeArm ......LeftForeArmRoll "
     "......LeftHand ...RightShoulder ....RightArm .....RightArmRoll .....RightForeArm "
     "......RightForeArmRoll ......RightHand ...Neck ....Head",
     "root=Reference hips=Hips chest=Spine neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_upper_leg=LeftUpLeg "
     "left_lower_leg=LeftLeg left_foot=LeftFoot"},
    {"mixamo",
     "mixamorig:Hips .mixamorig:Spine ..mixamorig:Spine1 ...mixamorig:Neck ....mixamorig:Head "
     ".....mixamorig:HeadTop_End .....mixamorig:LeftEye ...mixamorig:LeftShoulder "
     "....mixamorig:LeftArm .....mixamorig:LeftForeArm ......mixamorig:LeftHand "
     ".......mixamorig:LeftHandIndex1 ...mixamorig:RightShoulder ....mixamorig:RightArm "
     ".....mixamorig:RightForeArm ......mixamorig:RightHand .......mixamorig:RightHandIndex1 "
     ".mixamorig:LeftUpLeg ..mixamorig:LeftLeg ...mixamorig:LeftFoot ....mixamorig:LeftToeBase "
     ".mixamorig:RightUpLeg ..mixamorig:RightLeg ...mixamorig:RightFoot ....mixamorig:RightToeBase",
     "hips=mixamorig:Hips spine=mixamorig:Spine chest=mixamorig:Spine1 neck=mixamorig:Neck "
     "head=mixamorig:Head left_collar=mixamorig:LeftShoulder left_upper_arm=mixamorig:LeftArm "
     "left_lower_arm=mixamorig:LeftForeArm left_hand=mixamorig:LeftHand "
     "left_fingers=mixamorig:LeftHandIndex1 left_upper_leg=mixamorig:LeftUpLeg "
     "left_lower_leg=mixamorig:LeftLeg left_foot=mixamorig:LeftFoot "
     "left_toes=mixamorig:LeftToeBase"},
    {"cmu",
     "Hips .LHipJoint ..LeftUpLeg ...LeftLeg ....LeftFoot .....LeftToeBase .RHipJoint ..RightUpLeg "
     "...RightLeg ....RightFoot .....RightToeBase .LowerBack ..Spine ...Spine1 ....Neck .....Neck1 "
     "......Head ....LeftShoulder .....LeftArm ......LeftForeArm .......LeftHand "
     "........LeftFingerBase .........LFingers ........LThumb ....RightShoulder .....RightArm "
     "......RightForeArm .......RightHand ........RightFingerBase .........RFingers ........RThumb",
     "hips=Hips spine=LowerBack chest=Spine1 neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_fingers=LeftFingerBase left_upper_leg=LeftUpLeg left_lower_leg=LeftLeg "
     "left_foot=LeftFoot left_toes=LeftToeBase"},
    {"acclaim",
     "root .lhipjoint ..lfemur ...ltibia ....lfoot .....ltoes .rhipjoint ..rfemur ...rtibia "
     "....rfoot .....rtoes .lowerback ..upperback ...thorax ....lowerneck .....upperneck "
     "......head "
     "....lclavicle .....lhumerus ......lradius .......lwrist ........lhand .........lfingers "
     "........lthumb ....rclavicle .....rhumerus ......rradius .......rwrist ........rhand "
     ".........rfingers ........rthumb",
     "hips=root spine=lowerback chest=thorax neck=lowerneck head=head left_collar=lclavicle "
     "left_upper_arm=lhumerus left_lower_arm=lradius left_hand=lwrist left_fingers=lhand "
     "left_upper_leg=lfemur left_lower_leg=ltibia left_foot=lfoot left_toes=ltoes"},
    {"biovision_limbs",
     "Hips .Chest ..Neck ...Head ..LeftCollar ...LeftUpArm ....LeftLowArm .....LeftHand "
     "..RightCollar ...RightUpArm ....RightLowArm .....RightHand .LeftUpLeg ..LeftLowLeg "
     "...LeftFoot "
     ".RightUpLeg ..RightLowLeg ...RightFoot",
     "hips=Hips chest=Chest neck=Neck head=Head left_collar=LeftCollar left_upper_arm=LeftUpArm "
     "left_lower_arm=LeftLowArm left_hand=LeftHand left_upper_leg=LeftUpLeg "
     "left_lower_leg=LeftLowLeg left_foot=LeftFoot"},
    {"biovision_places",
     "Hips .LeftHip ..LeftKnee ...LeftAnkle ....LeftToe .RightHip ..RightKnee ...RightAnkle "
     "....RightToe .Chest ..Chest2 ...LeftCollar ....LeftShoulder .....LeftElbow ......LeftWrist "
     "...RightCollar ....RightShoulder .....RightElbow ......RightWrist ...Neck ....Head",
     "hips=Hips spine=Chest chest=Chest2 neck=Neck head=Head left_collar=LeftCollar "
     "left_upper_arm=LeftShoulder left_lower_arm=LeftElbow left_hand=LeftWrist "
     "left_upper_leg=LeftHip left_lower_leg=LeftKnee left_foot=LeftAnkle left_toes=LeftToe"},
    {"poser",
     "hip .abdomen ..chest ...neck ....head .....leftEye ...lCollar ....lShldr .....lForeArm "
     "......lHand .......lThumb1 ...rCollar ....rShldr .....rForeArm ......rHand .......rThumb1 "
     ".lButtock ..lThigh ...lShin ....lFoot .....lToe .rButtock ..rThigh ...rShin ....rFoot "
     ".....rToe",
     "hips=hip spine=abdomen chest=chest neck=neck head=head left_collar=lCollar "
     "left_upper_arm=lShldr left_lower_arm=lForeArm left_hand=lHand left_fingers=lThumb1 "
     "left_upper_leg=lThigh left_lower_leg=lShin left_foot=lFoot left_toes=lToe"},
    {"second_life",
     "mPelvis .mTorso ..mChest ...mNeck ....mHead ...mCollarLeft ....mShoulderLeft .....mElbowLeft "
     "......mWristLeft ...mCollarRight ....mShoulderRight .....mElbowRight ......mWristRight "
     ".mHipRight ..mKneeRight ...mAnkleRight ....mFootRight .....mToeRight .mHipLeft ..mKneeLeft "
     "...mAnkleLeft ....mFootLeft .....mToeLeft",
     "hips=mPelvis spine=mTorso chest=mChest neck=mNeck head=mHead left_collar=mCollarLeft "
     "left_upper_arm=mShoulderLeft left_lower_arm=mElbowLeft left_hand=mWristLeft "
     "left_upper_leg=mHipLeft left_lower_leg=mKneeLeft left_foot=mAnkleLeft left_toes=mFootLeft"},
    {"daz_genesis",
     "hip .pelvis ..lThighBend ...lThighTwist ....lShin .....lFoot ......lMetatarsals .......lToe "
     "..rThighBend ...rThighTwist ....rShin .....rFoot ......rMetatarsals .......rToe "
     ".abdomenLower "
     "..abdomenUpper ...chestLower ....chestUpper .....lCollar ......lShldrBend .......lShldrTwist "
     "........lForearmBend .........lForearmTwist ..........lHand ...........lCarpal1 .....rCollar "
     "......rShldrBend .......rShldrTwist ........rForearmBend .........rForearmTwist "
     "..........rHand "
     "...........rCarpal1 .....neckLower ......neckUpper .......head",
     "hips=hip spine=abdomenLower chest=chestUpper neck=neckLower head=head left_collar=lCollar "
     "left_upper_arm=lShldrBend left_lower_arm=lForearmBend left_hand=lHand left_fingers=lCarpal1 "
     "left_upper_leg=lThighBend left_lower_leg=lShin left_foot=lFoot left_toes=lToe"},
    {"mesh_joints_beside_toes",
     "Hips .Spine ..Chest ...Neck ....Head ...LeftShoulder ....LeftArm .....LeftForeArm "
     "......LeftHand ...RightShoulder ....RightArm .....RightForeArm ......RightHand "
     ".LeftUpLeg ..LeftLeg ...LeftFoot ....LeftToeBase ....L_Talus_Mesh "
     ".RightUpLeg ..RightLeg ...RightFoot ....R_Talus_Mesh ....RightToeBase",
     "hips=Hips spine=Spine chest=Chest neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_upper_leg=LeftUpLeg left_lower_leg=LeftLeg left_foot=LeftFoot left_toes=LeftToeBase"},
    {"iclone",
     "RL_BoneRoot .CC_Base_Hip ..CC_Base_Pelvis ...CC_Base_L_Thigh ....CC_Base_L_Calf "
     ".....CC_Base_L_Foot ......CC_Base_L_ToeBaseShareBone ......CC_Base_L_ToeBase "
     ".....CC_Base_L_CalfTwist01 ...CC_Base_R_Thigh ....CC_Base_R_Calf .....CC_Base_R_Foot "
     "......CC_Base_R_ToeBaseShareBone ......CC_Base_R_ToeBase .....CC_Base_R_CalfTwist01 "
     "..CC_Base_Waist ...CC_Base_Spine01 ....CC_Base_Spine02 .....CC_Base_NeckTwist01 "
     "......CC_Base_Head .......CC_Base_FacialBone ........CC_Base_JawRoot .....CC_Base_L_Clavicle "
     "......CC_Base_L_Upperarm .......CC_Base_L_UpperarmTwist01 .......CC_Base_L_Forearm "
     "........CC_Base_L_ElbowShareBone ........CC_Base_L_Hand .........CC_Base_L_Mid1 "
     ".....CC_Base_R_Clavicle ......CC_Base_R_Upperarm .......CC_Base_R_UpperarmTwist01 "
     ".......CC_Base_R_Forearm ........CC_Base_R_ElbowShareBone ........CC_Base_R_Hand "
     ".........CC_Base_R_Mid1 .....CC_Base_L_RibsTwist ......CC_Base_L_Breast",
     "root=RL_BoneRoot hips=CC_Base_Hip spine=CC_Base_Waist chest=CC_Base_Spine02 "
     "neck=CC_Base_NeckTwist01 head=CC_Base_Head left_collar=CC_Base_L_Clavicle "
     "left_upper_arm=CC_Base_L_Upperarm left_lower_arm=CC_Base_L_Forearm left_hand=CC_Base_L_Hand "
     "left_fingers=CC_Base_L_Mid1 left_upper_leg=CC_Base_L_Thigh left_lower_leg=CC_Base_L_Calf "
     "left_foot=CC_Base_L_Foot left_toes=CC_Base_L_ToeBase"},
    {"xsens_mvn",
     "Pelvis .L5 ..L3 ...T12 ....T8 .....Neck ......Head .....RightShoulder ......RightUpperArm "
     ".......RightForeArm ........RightHand .....LeftShoulder ......LeftUpperArm "
     ".......LeftForeArm "
     "........LeftHand .RightUpperLeg ..RightLowerLeg ...RightFoot ....RightToe .LeftUpperLeg "
     "..LeftLowerLeg ...LeftFoot ....LeftToe",
     "hips=Pelvis spine=L5 chest=T8 neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftUpperArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_upper_leg=LeftUpperLeg left_lower_leg=LeftLowerLeg left_foot=LeftFoot "
     "left_toes=LeftToe"},
    {"rokoko",
     "Hips .Spine1 ..Spine2 ...Spine3 ....Spine4 .....Neck ......Head .....LeftShoulder "
     "......LeftArm "
     ".......LeftForeArm ........LeftHand .........LeftFinger1Metacarpal .....RightShoulder "
     "......RightArm .......RightForeArm ........RightHand .........RightFinger1Metacarpal "
     ".LeftThigh ..LeftShin ...LeftFoot ....LeftToe .....LeftToeTip .RightThigh ..RightShin "
     "...RightFoot ....RightToe .....RightToeTip",
     "hips=Hips spine=Spine1 chest=Spine4 neck=Neck head=Head left_collar=LeftShoulder "
     "left_upper_arm=LeftArm left_lower_arm=LeftForeArm left_hand=LeftHand "
     "left_fingers=LeftFinger1Metacarpal left_upper_leg=LeftThigh left_lower_leg=LeftShin "
     "left_foot=LeftFoot left_toes=LeftToe"},
    {"optitrack",
     "Skeleton1_Hip .Skeleton1_Ab ..Skeleton1_Chest ...Skeleton1_Neck ....Skeleton1_Head "
     "...Skeleton1_LShoulder ....Skeleton1_LUArm .....Skeleton1_LFArm ......Skeleton1_LHand "
     ".......Skeleton1_LThumb1 ...Skeleton1_RShoulder ....Skeleton1_RUArm .....Skeleton1_RFArm "
     "......Skeleton1_RHand .......Skeleton1_RThumb1 .Skeleton1_LThigh ..Skeleton1_LShin "
     "...Skeleton1_LFoot ....Skeleton1_LToe .Skeleton1_RThigh ..Skeleton1_RShin ...Skeleton1_RFoot "
     "....Skeleton1_RToe",
     "hips=Skeleton1_Hip spine=Skeleton1_Ab chest=Skeleton1_Chest neck=Skeleton1_Neck "
     "head=Skeleton1_Head left_collar=Skeleton1_LShoulder left_upper_arm=Skeleton1_LUArm "
     "left_lower_arm=Skeleton1_LFArm left_hand=Skeleton1_LHand left_fingers=Skeleton1_LThumb1 "
     "left_upper_leg=Skeleton1_LThigh left_lower_leg=Skeleton1_LShin left_foot=Skeleton1_LFoot "
     "left_toes=Skeleton1_LToe"},
    {"perception_neuron",
     "Robot_Hips .Robot_RightUpLeg ..Robot_RightLeg ...Robot_RightFoot .Robot_LeftUpLeg "
     "..Robot_LeftLeg ...Robot_LeftFoot .Robot_Spine ..Robot_Spine1 ...Robot_Spine2 "
     "....Robot_Spine3 "
     ".....Robot_Neck ......Robot_Head .....Robot_RightShoulder ......Robot_RightArm "
     ".......Robot_RightForeArm ........Robot_RightHand .........Robot_RightInHandIndex "
     "..........Robot_RightHandIndex1 .....Robot_LeftShoulder ......Robot_LeftArm "
     ".......Robot_LeftForeArm ........Robot_LeftHand .........Robot_LeftInHandIndex "
     "..........Robot_LeftHandIndex1",
     "hips=Robot_Hips spine=Robot_Spine chest=Robot_Spine3 neck=Robot_Neck head=Robot_Head "
     "left_collar=Robot_LeftShoulder left_upper_arm=Robot_LeftArm left_lower_arm=Robot_LeftForeArm "
     "left_hand=Robot_LeftHand left_fingers=Robot_LeftInHandIndex left_upper_leg=Robot_LeftUpLeg "
     "left_lower_leg=Robot_LeftLeg left_foot=Robot_LeftFoot"},
    {"makehuman",
     "root .pelvis.L ..upperleg01.L ...upperleg02.L ....lowerleg01.L .....lowerleg02.L "
     "......foot.L "
     ".......toe1-1.L .pelvis.R ..upperleg01.R ...upperleg02.R ....lowerleg01.R .....lowerleg02.R "
     "......foot.R .......toe1-1.R .spine05 ..spine04 ...spine01 ....clavicle.L .....shoulder01.L "
     "......upperarm01.L .......upperarm02.L ........lowerarm01.L .........lowerarm02.L "
     "..........wrist.L ...........metacarpal1.L ....clavicle.R .....shoulder01.R "
     "......upperarm01.R "
     ".......upperarm02.R ........lowerarm01.R .........lowerarm02.R ..........wrist.R "
     "...........metacarpal1.R ....neck01 .....neck02 ......head .......jaw .......eye.L",
     "hips=root spine=spine05 chest=spine01 neck=neck01 head=head left_collar=clavicle.L "
     "left_upper_arm=upperarm01.L left_lower_arm=lowerarm01.L left_hand=wrist.L "
     "left_fingers=metacarpal1.L left_upper_leg=upperleg01.L left_lower_leg=lowerleg01.L "
     "left_foot=foot.L left_toes=toe1-1.L"},
    {"biped",
     "Bip01 .Bip01_Pelvis ..Bip01_Spine ...Bip01_L_Thigh ....Bip01_L_Calf .....Bip01_L_Foot "
     "......Bip01_L_Toe0 ...Bip01_R_Thigh ....Bip01_R_Calf .....Bip01_R_Foot ......Bip01_R_Toe0 "
     "...Bip01_Spine1 ....Bip01_Neck .....Bip01_Head .....Bip01_L_Clavicle ......Bip01_L_UpperArm "
     ".......Bip01_L_Forearm ........Bip01_L_Hand .........Bip01_L_Finger0 .....Bip01_R_Clavicle "
     "......Bip01_R_UpperArm .......Bip01_R_Forearm ........Bip01_R_Hand .........Bip01_R_Finger0",
     "root=Bip01 hips=Bip01_Pelvis spine=Bip01_Spine chest=Bip01_Neck head=Bip01_Head "
     "left_collar=Bip01_L_Clavicle left_upper_arm=Bip01_L_UpperArm left_lower_arm=Bip01_L_Forearm "
     "left_hand=Bip01_L_Hand left_fingers=Bip01_L_Finger0 left_upper_leg=Bip01_L_Thigh "
     "left_lower_leg=Bip01_L_Calf left_foot=Bip01_L_Foot left_toes=Bip01_L_Toe0"},
    {"biped_german",
     "Bip01 .Bip01_Becken ..Bip01_Wirbelsäule ...Bip01_L_Oberschenkel ....Bip01_L_Wade "
     ".....Bip01_L_Fuß "
     "......Bip01_L_Zehe0 ...Bip01_R_Oberschenkel ....Bip01_R_Wade .....Bip01_R_Fuß "
     "......Bip01_R_Zehe0 "
     "...Bip01_Wirbelsäule1 ....Bip01_Hals .....Bip01_Kopf .....Bip01_L_Schlüsselbein "
     "......Bip01_L_Oberarm "
     ".......Bip01_L_Unterarm ........Bip01_L_Hand .........Bip01_L_Finger0 "
     ".....Bip01_R_Schlüsselbein "
     "......Bip01_R_Oberarm .......Bip01_R_Unterarm ........Bip01_R_Hand .........Bip01_R_Finger0",
     "root=Bip01 hips=Bip01_Becken spine=Bip01_Wirbelsäule chest=Bip01_Hals head=Bip01_Kopf "
     "left_collar=Bip01_L_Schlüsselbein left_upper_arm=Bip01_L_Oberarm "
     "left_lower_arm=Bip01_L_Unterarm "
     "left_hand=Bip01_L_Hand left_fingers=Bip01_L_Finger0 left_upper_leg=Bip01_L_Oberschenkel "
     "left_lower_leg=Bip01_L_Wade left_foot=Bip01_L_Fuß left_toes=Bip01_L_Zehe0"},
    {"unreal",
     "root .pelvis ..spine_01 ...spine_02 ....clavicle_l .....upperarm_l ......upperarm_twist_01_l "
     "......lowerarm_l .......hand_l ........index_01_l ....clavicle_r .....upperarm_r "
     "......upperarm_twist_01_r ......lowerarm_r .......hand_r ........index_01_r ....neck_01 "
     ".....head ..thigh_l ...calf_l ....foot_l .....ball_l ..thigh_r ...calf_r ....foot_r "
     ".....ball_r "
     ".ik_foot_root ..ik_foot_l ..ik_foot_r .ik_hand_root ..ik_hand_l ..ik_hand_r",
     "root=root hips=pelvis spine=spine_01 chest=spine_02 neck=neck_01 head=head "
     "left_collar=clavicle_l left_upper_arm=upperarm_l left_lower_arm=lowerarm_l left_hand=hand_l "
     "left_fingers=index_01_l left_upper_leg=thigh_l left_lower_leg=calf_l left_foot=foot_l "
     "left_toes=ball_l"},
    {"numbered_limbs",
     "Armature .Skeleton_torso_joint_1 ..leg_joint_R_1 ...leg_joint_R_2 ....leg_joint_R_3 "
     ".....leg_joint_R_5 ..leg_joint_L_1 ...leg_joint_L_2 ....leg_joint_L_3 .....leg_joint_L_5 "
     "..Skeleton_torso_joint_2 ...torso_joint_3 ....Skeleton_arm_joint_R "
     ".....Skeleton_arm_joint_R__2_ ......Skeleton_arm_joint_R__3_ ....Skeleton_arm_joint_L__4_ "
     ".....Skeleton_arm_joint_L__3_ ......Skeleton_arm_joint_L__2_ ....Skeleton_neck_joint_1 "
     ".....Skeleton_neck_joint_2",
     "root=Armature hips=Skeleton_torso_joint_1 spine=Skeleton_torso_joint_2 chest=torso_joint_3 "
     "neck=Skeleton_neck_joint_1 head=Skeleton_neck_joint_2 "
     "left_upper_arm=Skeleton_arm_joint_L__4_ left_lower_arm=Skeleton_arm_joint_L__3_ "
     "left_hand=Skeleton_arm_joint_L__2_ left_upper_leg=leg_joint_L_1 "
     "left_lower_leg=leg_joint_L_2 left_foot=leg_joint_L_3 left_toes=leg_joint_L_5"},
    {"smartbody_h_anim",
     "base .spine1 ..spine2 ...spine3 ....spine4 .....spine5 ......skullbase "
     "....l_sternoclavicular .....l_acromioclavicular ......l_shoulder .......l_elbow "
     "........l_wrist ....r_sternoclavicular .....r_acromioclavicular ......r_shoulder "
     ".......r_elbow ........r_wrist .l_hip ..l_knee ...l_ankle ....l_midtarsal .r_hip ..r_knee "
     "...r_ankle ....r_midtarsal",
     "hips=base spine=spine1 chest=spine3 neck=spine4 head=skullbase "
     "left_collar=l_sternoclavicular left_upper_arm=l_shoulder left_lower_arm=l_elbow "
     "left_hand=l_wrist left_upper_leg=l_hip left_lower_leg=l_knee left_foot=l_ankle "
     "left_toes=l_midtarsal"},
    {"mmd",
     "全ての親 .センター ..グルーブ ...腰 ....上半身 .....上半身2 ......首 .......頭 ........左目 "
     "........右目 ......左肩 .......左腕 ........左腕捩 .........左ひじ ..........左手捩 "
     "...........左手首 ............左親指０ ............左人指１ .............左人指２ ......右肩 "
     ".......右腕 ........右腕捩 .........右ひじ ..........右手捩 ...........右手首 "
     "............右親指０ ............右人指１ .............右人指２ ....下半身 .....左足 "
     "......左ひざ .......左足首 ........左つま先 .....右足 ......右ひざ .......右足首 "
     "........右つま先 .左足ＩＫ ..左つま先ＩＫ .右足ＩＫ ..右つま先ＩＫ",
     "root=全ての親 hips=腰 spine=上半身 chest=上半身2 neck=首 head=頭 left_collar=左肩 "
     "left_upper_arm=左腕 left_lower_arm=左ひじ left_hand=左手首 left_fingers=左親指０ "
     "left_upper_leg=左足 left_lower_leg=左ひざ left_foot=左足首 left_toes=左つま先"},
    {"no_collars_no_neck",
     "hips .spine ..head ..left_arm ...left_forearm ....left_hand ..right_arm ...right_forearm "
     "....right_hand .left_leg ..left_knee ...left_ankle .right_leg ..right_knee ...right_ankle",
     "hips=hips chest=spine head=head left_upper_arm=left_arm left_lower_arm=left_forearm "
     "left_hand=left_hand left_upper_leg=left_leg left_lower_leg=left_knee left_foot=left_ankle"}};

INSTANTIATE_TEST_SUITE_P(Exporters, RoleSchemes, testing::ValuesIn(kSchemes),
                         [](const auto& test_case) {
                           return std::string(test_case.param.exporter);
                         });

TEST(Roles, EveryJointBeyondTheWristIsAFinger) {
  const Skeleton skeleton = skeleton_from_text(kSchemes[0].joints);
  const RoleMap map = find_roles(skeleton);
  EXPECT_EQ(std::count(map.roles.begin(), map.roles.end(), Role::left_fingers), 3);
  EXPECT_EQ(map.roles[static_cast<std::size_t>(skeleton.find("LFinger11"))], Role::left_fingers);
  EXPECT_EQ(map.roles[static_cast<std::size_t>(skeleton.find("Head_end"))], Role::end);
}

}  // namespace
}  // namespace krok
