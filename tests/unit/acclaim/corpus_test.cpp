// The CMU collection's own files. If these fail, captures of the collection come in with wrong
// positions: a rotation about the wrong axes or in the wrong order, a bone of the wrong length, a
// wrong unit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "formats/acclaim/acclaim_reader.h"
#include "support/this_build.h"
#include "unit/acclaim/naive_kinematics.h"

namespace {

using krok::acclaim::Capture;

constexpr double kCmuUnit = 0.0254 / 0.45;

std::string corpus(const std::string& path) {
  return krok::test::corpus_folder() + "/" + path;
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class AcclaimCorpus : public testing::TestWithParam<std::pair<std::string, std::string>> {
 protected:
  void SetUp() override {
    const auto& [asf, amc] = GetParam();
    asf_ = corpus("other/asf_amc_cmu/" + asf);
    amc_ = corpus("other/asf_amc_cmu/" + amc);
    if (!std::filesystem::exists(asf_)) GTEST_SKIP() << "skipped: no corpus at " << asf_;
  }
  std::string asf_, amc_;
};

TEST_P(AcclaimCorpus, agrees_with_naive_forward_kinematics_in_all_frames) {
  const std::string asf = content(asf_), amc = content(amc_);
  const auto capture = krok::acclaim::read(asf, asf_, amc, amc_);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const krok::Clip& clip = capture->clip;
  ASSERT_TRUE(check(clip).ok()) << check(clip).error().message;
  const naive::Acclaim expected(asf, amc);
  ASSERT_EQ(static_cast<std::size_t>(clip.frame_count()), expected.frame_count());

  double worst = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const naive::Positions positions = expected.frame(static_cast<std::size_t>(f));
    for (int j = 0; j < clip.joint_count(); ++j) {
      const auto index = static_cast<std::size_t>(j);
      std::string name = clip.skeleton.names[index];
      if (clip.skeleton.end_sites[index] != 0) {
        name = clip.skeleton.names[static_cast<std::size_t>(clip.skeleton.parents[index])] + " end";
      }
      const Eigen::Vector3d place = positions.at(name) * kCmuUnit;
      const Eigen::Vector3d read = clip.frame_positions(f)[index].cast<double>();
      worst = std::max(worst, (read - place).norm());
    }
  }
  const double size = krok::reference_extent(clip.skeleton);
  std::printf("%s: %d frames, %d joints, largest difference %.3g m, %.3g of the figure's size\n",
              amc_.c_str(), clip.frame_count(), clip.joint_count(), worst, worst / size);
  EXPECT_LT(worst, 2e-5 * size);
}

TEST_P(AcclaimCorpus, reference_pose_agrees_with_naive_forward_kinematics) {
  const std::string asf = content(asf_);
  const auto capture = krok::acclaim::read(asf, asf_, {}, {});
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.frame_count(), 0);
  const naive::Positions expected = naive::Acclaim(asf, "").reference();
  const krok::Skeleton& skeleton = capture->clip.skeleton;
  ASSERT_TRUE(check(skeleton).ok());
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    if (skeleton.end_sites[j] != 0) continue;
    EXPECT_LT((skeleton.reference[j].position - expected.at(skeleton.names[j]) * kCmuUnit).norm(),
              1e-5)
        << skeleton.names[j];
  }
}

TEST_P(AcclaimCorpus, is_taken_as_upright_person_in_the_unit_of_the_collection) {
  const auto capture = krok::acclaim::read(content(asf_), asf_, content(amc_), amc_);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->conventions.unit.name, "cmu");
  EXPECT_EQ(capture->conventions.unit_confidence, krok::Confidence::certain);
  EXPECT_EQ(capture->conventions.up, krok::Direction::plus_y);
  EXPECT_EQ(capture->conventions.forward, krok::Direction::plus_z);
  EXPECT_EQ(capture->clip.rate, 120.0);
  const krok::Skeleton& skeleton = capture->clip.skeleton;
  EXPECT_EQ(skeleton.joint_count(), 31 + 7);  // toes, fingers, thumbs and the head end
  for (const char* name : {"root", "lhipjoint", "lfemur", "ltibia", "rfingers", "head_end"}) {
    EXPECT_GE(skeleton.find(name), 0) << name;
  }
}

TEST_P(AcclaimCorpus, does_not_depend_on_the_number_of_threads) {
  const std::string asf = content(asf_), amc = content(amc_);
  krok::acclaim::ReadOptions one, two;
  one.jobs = 1;
  two.jobs = 2;
  const auto a = krok::acclaim::read(asf, asf_, amc, amc_, one);
  const auto b = krok::acclaim::read(asf, asf_, amc, amc_, two);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_TRUE(a->clip.positions == b->clip.positions);
  for (std::size_t i = 0; i < a->clip.orientations.size(); ++i) {
    ASSERT_TRUE(a->clip.orientations[i].coeffs() == b->clip.orientations[i].coeffs());
  }
}

INSTANTIATE_TEST_SUITE_P(cmu, AcclaimCorpus,
                         testing::Values(std::pair("01.asf", "01_01.amc"),
                                         std::pair("11.asf", "11_01.amc")),
                         [](const auto& test) {
                           return "subject_" + test.param.first.substr(0, 2);
                         });

// The same motion as another program brought it to BVH, with another rest pose. That program left
// out the bone from the thorax to the neck and the collar bones, and the one from the wrist to the
// hand; the former is put back here from the BVH's own orientations.
TEST(AcclaimAgainstBvh, the_same_motion_converted_by_another_program_agrees) {
  const std::string asf_path = corpus("other/asf_amc_cmu/01.asf");
  const std::string amc_path = corpus("other/asf_amc_cmu/01_01.amc");
  const std::string bvh_path = corpus("bvh/assimp_testmodels/01_01.bvh");
  if (!std::filesystem::exists(bvh_path) || !std::filesystem::exists(amc_path)) {
    GTEST_SKIP() << "skipped: no corpus at " << bvh_path;
  }
  const auto capture =
      krok::acclaim::read(content(asf_path), asf_path, content(amc_path), amc_path);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const krok::Clip& clip = capture->clip;
  const naive::Bvh bvh(content(bvh_path));
  // One frame more: a rest pose comes first.
  ASSERT_EQ(bvh.frame_count(), static_cast<std::size_t>(clip.frame_count()) + 1);

  const std::vector<std::pair<std::string, std::string>> pairs = {
      {"root", "Hips"},       {"lfemur", "LeftUpLeg"},  {"ltibia", "LeftLeg"},
      {"lfoot", "LeftFoot"},  {"ltoes", "LeftToeBase"}, {"rfemur", "RightUpLeg"},
      {"rtibia", "RightLeg"}, {"rfoot", "RightFoot"},   {"rtoes", "RightToeBase"},
      {"upperback", "Spine"}, {"thorax", "Spine1"},     {"lowerneck", "Neck"},
      {"head", "Head"},       {"lhumerus", "LeftArm"},  {"lradius", "LeftForeArm"},
      {"lwrist", "LeftHand"}, {"rhumerus", "RightArm"}, {"rradius", "RightForeArm"},
      {"rwrist", "RightHand"}};
  const int thorax = clip.skeleton.find("thorax");
  const Eigen::Vector3d thorax_bone =
      (clip.skeleton.reference[static_cast<std::size_t>(clip.skeleton.find("lowerneck"))].position -
       clip.skeleton.reference[static_cast<std::size_t>(thorax)].position) /
      kCmuUnit;
  double worst = 0;
  std::string worst_joint;
  for (int f = 0; f < clip.frame_count(); f += 10) {
    std::map<std::string, Eigen::Matrix3d> rotations;
    const naive::Positions other = bvh.frame(static_cast<std::size_t>(f) + 1, &rotations);
    const Eigen::Vector3d left_out = rotations.at("Spine1") * thorax_bone;
    for (const auto& [name, other_name] : pairs) {
      const int joint = clip.skeleton.find(name);
      ASSERT_GE(joint, 0) << name;
      Eigen::Vector3d place = other.at(other_name);
      if (name == "lowerneck" || name == "head" || name.find("humerus") != std::string::npos ||
          name.find("radius") != std::string::npos || name.find("wrist") != std::string::npos) {
        place += left_out;
      }
      const Eigen::Vector3d read =
          clip.frame_positions(f)[static_cast<std::size_t>(joint)].cast<double>();
      const double difference = (read - place * kCmuUnit).norm();
      if (difference > worst) worst_joint = name;
      worst = std::max(worst, difference);
    }
  }
  std::printf("largest difference to the BVH %.3g m, at %s\n", worst, worst_joint.c_str());
  EXPECT_LT(worst, 0.001);
}

}  // namespace
