// Every capture of the corpus, with what a person sees in it: the joints by name, the height of
// heads and feet for unit and up, left and right hips and toes for forward. If a row fails,
// captures of that exporter arrive too large, lying, facing aside or with limbs mistaken.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "roles/roles.h"
#include "support/this_build.h"

namespace krok {
namespace {

// Empty joints: no person. "?": not to be told from the data. The two fair1 files are of a figure
// about 1.2 m tall if in inches and 2.6 m in the CMU collection's unit; the others marked so are no
// persons.
struct Truth {
  const char* file;
  const char* hips;
  const char* head;
  const char* left_hand;
  const char* unit;
  const char* up;
  const char* forward;
};

const Truth kTruths[] = {
    {"20tab_bvh-python/test_freebvh.bvh", "mixamorig:Hips", "mixamorig:Head", "mixamorig:LeftHand",
     "cm", "y", "z"},
    {"20tab_bvh-python/test_mocapbank.bvh", "Hips", "Head", "LeftWrist", "cm", "y", "z"},
    {"animated_drawings/cmu1_jumping_jacks.bvh", "Hips", "Head", "LeftWrist", "cmu", "y", "z"},
    {"animated_drawings/fair1_dab.bvh", "Hips", "Head", "LeftHand", "?", "z", "-y"},
    {"animated_drawings/fair1_zombie.bvh", "Hips", "Head", "LeftHand", "?", "z", "-y"},
    {"animated_drawings/rokoko_jesse_dance.bvh", "Hips", "Head", "LeftHand", "cm", "y", "z"},
    {"assimp_testmodels/01_01.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"assimp_testmodels/01_03.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"bvh-toolbox/test_mocapbank.bvh", "Hips", "Head", "LeftWrist", "cm", "y", "z"},
    {"bvhio/example.bvh", "Hips", "Head", "LeftHand", "in", "y", "z"},
    {"deep-motion-editing/blender_rendering_example.bvh", "Hips", "Head", "LeftHand", "cmu", "y",
     "z"},
    {"deep-motion-editing/demo_3d_1_raw.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"deep-motion-editing/global_info_rest.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"deep-motion-editing/xia_test_neutral_01_000.bvh", "Hips", "Head", "LeftHand", "cmu", "y",
     "z"},
    {"deep-motion-editing/xia_test_old_13_000.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"fairmotion/pfnn_hierarchy.bvh", "Hips", "Head", "LeftHand", "m", "y", "z"},
    {"fairmotion/sinusoidal.bvh", "", "", "", "?", "?", "?"},
    {"iclone_cmu/002_01.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"iclone_cmu/002_03.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"iclone_cmu/003_01.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"iclone_cmu/005_01.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"iclone_cmu/006_01.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"iclone_cmu/006_09.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"ipi_smartbody/CatchSkeleton.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Center2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Center_Up.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Left2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Low_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Lower_Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Lower_Right2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Far_Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Low_Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Low_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Low_Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Low_Right2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatLeft.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatLow_Far_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatLow_Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatLow_Right2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatLow_Right_Far.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatRight.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Center2.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Far_Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Far_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/SwatUp_Right.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Up_Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Up_Left.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Up_Left_Center.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"ipi_smartbody/Up_Right_Far.bvh", "Hip", "Head", "LHand", "cm", "y", "z"},
    {"makehuman/02_02.bvh", "hip", "head", "lHand", "cm", "y", "z"},
    {"makehuman/12_03.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"makehuman/benchmark.bvh", "root", "head", "wrist.L", "dm", "z", "-y"},
    {"makehuman/dance1.bvh", "Root", "Head", "Hand_L", "dm", "z", "-y"},
    {"makehuman/debug.bvh", "Hips", "Head", "LeftWrist", "in", "y", "z"},
    {"makehuman/example1.bvh", "Hips", "Head", "LeftHand", "in", "y", "z"},
    {"makehuman/face-poseunits.bvh", "root", "head", "wrist.L", "dm", "z", "-y"},
    {"makehuman/mh-rigging351-benchmark1.bvh", "root", "head", "wrist.L", "dm", "y", "z"},
    {"makehuman/test-staging-01.bvh", "root", "head", "wrist.L", "dm", "z", "-y"},
    {"makehuman/walk1.bvh", "Root", "Head", "Hand_L", "dm", "z", "-y"},
    {"makehuman/zombieWalk1.bvh", "Root", "Head", "Hand_L", "dm", "z", "-y"},
    {"optitrack_arena_bvh-matlab/louise.bvh", "Hips", "Head", "LeftWrist", "cm", "y", "z"},
    {"optitrack_arena_bvh-matlab/walk.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"pybvh/bvh_test1.bvh", "Hips", "Head", "LeftHand", "in", "z", "y"},
    {"pybvh/bvh_test2.bvh", "Hips", "Head", "LeftWrist", "cm", "y", "z"},
    {"pybvh/bvh_test3.bvh", "Hips", "Head", "LeftHand", "in", "z", "-y"},
    {"pybvh/bvh_test4.bvh", "Hips", "Head", "LeftHand", "in", "y", "z"},
    {"pybvh/cmu_12_01_walk.bvh", "Hips", "Head", "LeftHand", "cmu", "y", "z"},
    {"pybvh/full_precision_frame_time.bvh", "", "", "", "?", "?", "?"},
    {"pybvh/standard_skeleton.bvh", "Hips", "Head", "LeftHand", "in", "z", "y"},
    {"pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh", "Hips", "Head", "LeftHand", "in", "y", "z"},
    {"secondlife_opencollar/~jump-top.bvh", "hip", "head", "lHand", "in", "y", "z"},
    {"secondlife_opencollar/~run.bvh", "hip", "head", "lHand", "in", "y", "z"},
    {"secondlife_opencollar/~walk_Female.bvh", "hip", "head", "lHand", "in", "y", "z"},
    {"walkset_cmu07/007_02.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_03.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_04.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_05.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_06.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_08.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_09.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_10.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_11.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
    {"walkset_cmu07/007_12.bvh", "CC_Base_Hip", "CC_Base_Head", "CC_Base_L_Hand", "cm", "y", "z"},
};

class CorpusRoles : public testing::TestWithParam<Truth> {};

TEST_P(CorpusRoles, AreWhatAPersonSees) {
  const Truth& truth = GetParam();
  const std::string path = test::corpus_folder() + "/bvh/" + truth.file;
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder();
  const auto file = InputFile::open(path);
  ASSERT_TRUE(file.ok());
  const auto capture = bvh::read(file->text(), path, {});
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const Skeleton& skeleton = capture->clip.skeleton;
  const RoleMap roles = find_roles(skeleton);
  const auto named = [&](Role role) {
    const int joint = roles.joint(role);
    return joint < 0 ? std::string() : skeleton.names[static_cast<std::size_t>(joint)];
  };
  EXPECT_EQ(roles.humanoid, truth.hips[0] != '\0');
  EXPECT_EQ(named(Role::hips), truth.hips);
  EXPECT_EQ(named(Role::head), truth.head);
  EXPECT_EQ(named(Role::left_hand), truth.left_hand);
  const Conventions& found = capture->conventions;
  const auto hold = [](const std::string& text, const std::string& expected,
                       const std::string& why) {
    if (expected == "?") return;
    EXPECT_EQ(text, expected) << why;
  };
  hold(found.unit.name, truth.unit, found.unit_reason);
  hold(std::string(direction_name(found.up)), truth.up, found.up_reason);
  hold(std::string(direction_name(found.forward)), truth.forward, found.forward_reason);
  if (std::string(truth.unit) == "?") {
    EXPECT_EQ(found.unit_confidence, Confidence::guess) << found.unit_reason;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, CorpusRoles, testing::ValuesIn(kTruths), [](const auto& test_case) {
  std::string name = test_case.param.file;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
});

}  // namespace
}  // namespace krok
