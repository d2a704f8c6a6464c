// If these fail, real captures come out wrong on the skeletons of other exporters: limbs astray,
// sliding feet, knees the wrong way.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "support/this_build.h"
#include "tests/unit/retarget/actors.h"

namespace krok {
namespace {

using namespace test;

const std::string kCorpus = test::corpus_folder() + "/bvh/";

Clip load(const std::string& name) {
  const auto file = InputFile::open(kCorpus + name);
  EXPECT_TRUE(file.ok()) << name;
  auto capture = bvh::read(file->text(), name, {});
  EXPECT_TRUE(capture.ok()) << name;
  return std::move(capture->clip);
}

struct Pair {
  const char* name;
  const char* source;
  const char* target;
};
const Pair kPairs[] = {
    {"cmu_on_ipi", "pybvh/cmu_12_01_walk.bvh", "ipi_smartbody/Center.bvh"},
    {"cmu_on_mixamo", "pybvh/cmu_12_01_walk.bvh", "20tab_bvh-python/test_freebvh.bvh"},
    {"cmu_on_makehuman", "pybvh/cmu_12_01_walk.bvh", "makehuman/benchmark.bvh"},
    {"cmu_on_iclone", "pybvh/cmu_12_01_walk.bvh", "walkset_cmu07/007_02.bvh"},
    {"ipi_on_cmu", "ipi_smartbody/SwatLeft.bvh", "pybvh/cmu_12_01_walk.bvh"},
    {"ipi_on_mixamo", "ipi_smartbody/Far_Left.bvh", "20tab_bvh-python/test_freebvh.bvh"},
    {"ipi_on_makehuman", "ipi_smartbody/Far_Left.bvh", "makehuman/benchmark.bvh"},
    {"second_life_on_ipi", "secondlife_opencollar/~walk_Female.bvh", "ipi_smartbody/Center.bvh"},
    {"rokoko_on_ipi", "animated_drawings/rokoko_jesse_dance.bvh", "ipi_smartbody/Center.bvh"},
    {"iclone_on_mixamo", "walkset_cmu07/007_02.bvh", "20tab_bvh-python/test_freebvh.bvh"},
    {"mixamo_on_makehuman", "20tab_bvh-python/test_freebvh.bvh", "makehuman/benchmark.bvh"},
    {"iclone_on_cmu", "walkset_cmu07/007_02.bvh", "pybvh/cmu_12_01_walk.bvh"}};

class RetargetCorpus : public testing::TestWithParam<Pair> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kCorpus)) GTEST_SKIP() << "skipped: no corpus at " << kCorpus;
    source_ = load(GetParam().source);
    target_ = load(GetParam().target);
    source_roles_ = find_roles(source_.skeleton);
    target_roles_ = find_roles(target_.skeleton);
    auto result = retarget::transfer(source_, source_roles_, target_, target_roles_, {});
    ASSERT_TRUE(result.ok());
    result_ = std::move(*result);
  }

  static Vec3 place(const Clip& clip, const RoleMap& roles, int frame, Role role) {
    return clip.frame_positions(frame)[at(roles.joint(role))].cast<double>();
  }

  // Degrees between the source's bone and the target's.
  double angle(int frame, Role from, Role to) const {
    return degrees_between(
        place(source_, source_roles_, frame, to) - place(source_, source_roles_, frame, from),
        place(result_.clip, target_roles_, frame, to) -
            place(result_.clip, target_roles_, frame, from));
  }

  Clip source_, target_;
  RoleMap source_roles_, target_roles_;
  retarget::Retargeted result_;
};

TEST_P(RetargetCorpus, LimbsPointAsTheSources) {
  // Arms reach for what the source's hands touch; here rotations alone are looked at.
  auto by_rotations = retarget::transfer(source_, source_roles_, target_, target_roles_,
                                         {.touches = retarget::Touches::free});
  ASSERT_TRUE(by_rotations.ok());
  result_ = std::move(*by_rotations);
  double arms = 0;
  double legs = 0;
  double sum = 0;
  const int frames = source_.frame_count();
  for (int f = 0; f < frames; ++f) {
    for (const auto& [from, to] : {std::pair(Role::left_upper_arm, Role::left_lower_arm),
                                   std::pair(Role::left_lower_arm, Role::left_hand),
                                   std::pair(Role::right_upper_arm, Role::right_lower_arm),
                                   std::pair(Role::right_lower_arm, Role::right_hand)}) {
      arms = std::max(arms, angle(f, from, to));
    }
    for (const auto& [from, to] : {std::pair(Role::left_upper_leg, Role::left_lower_leg),
                                   std::pair(Role::left_lower_leg, Role::left_foot),
                                   std::pair(Role::right_upper_leg, Role::right_lower_leg),
                                   std::pair(Role::right_lower_leg, Role::right_foot)}) {
      legs = std::max(legs, angle(f, from, to));
      sum += angle(f, from, to) / (4.0 * frames);
    }
  }
  EXPECT_LT(arms, 0.1);
  EXPECT_LT(legs, 25) << "feet are kept by bending legs, but not that much";
  EXPECT_LT(sum, 8);
}

TEST_P(RetargetCorpus, FeetThatStandStand) {
  const double scale = result_.report.scale;
  double excess = 0;
  for (const Role foot : {Role::left_foot, Role::right_foot}) {
    // Where the source's ankle rests, the target's does: its speed beyond the source's own.
    for (int f = 0; f + 1 < source_.frame_count(); ++f) {
      const auto step = [&](const Clip& clip, const RoleMap& roles) {
        Vec3 by = place(clip, roles, f + 1, foot) - place(clip, roles, f, foot);
        by.y() = 0;
        return by.norm();
      };
      const double source_step = step(source_, source_roles_);
      if (source_step * source_.rate > 0.1) continue;
      excess = std::max(excess, step(result_.clip, target_roles_) - scale * source_step);
    }
  }
  EXPECT_LT(excess * source_.rate, 0.35) << "metres a second";
  ASSERT_TRUE(result_.report.left_foot && result_.report.right_foot);
  EXPECT_LT(result_.report.left_foot->largest_miss, 0.01);
  EXPECT_LT(result_.report.right_foot->largest_miss, 0.01);
}

TEST_P(RetargetCorpus, KneesBendForward) {
  const auto backward = [](const Clip& clip, const RoleMap& roles) {
    double most = 0;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const Vec3 left = place(clip, roles, f, Role::left_upper_leg) -
                        place(clip, roles, f, Role::right_upper_leg);
      for (const auto& [upper, lower, foot] :
           {std::tuple(Role::left_upper_leg, Role::left_lower_leg, Role::left_foot),
            std::tuple(Role::right_upper_leg, Role::right_lower_leg, Role::right_foot)}) {
        const Vec3 thigh = place(clip, roles, f, lower) - place(clip, roles, f, upper);
        const Vec3 shank = place(clip, roles, f, foot) - place(clip, roles, f, lower);
        most = std::max(most,
                        -std::atan2(thigh.cross(shank).dot(left.normalized()), thigh.dot(shank)));
      }
    }
    return most / kRadiansPerDegree;
  };
  EXPECT_LT(backward(result_.clip, target_roles_), backward(source_, source_roles_) + 2);
}

TEST_P(RetargetCorpus, TheActorStandsOnTheFloor) {
  // The lowest joint of the feet over the whole motion, against where it is in the target's stance.
  const auto lowest = [](const Clip& clip, const RoleMap& roles) {
    std::vector<double> heights;
    for (int f = 0; f < clip.frame_count(); ++f) {
      double least = 1e9;
      for (std::size_t j = 0; j < roles.roles.size(); ++j) {
        least = std::min<double>(least, clip.frame_positions(f)[j].y());
      }
      heights.push_back(least);
    }
    std::nth_element(heights.begin(), heights.begin() + std::ptrdiff_t(heights.size() / 5),
                     heights.end());
    return heights[heights.size() / 5];
  };
  const double source_height = result_.report.scale * lowest(source_, source_roles_);
  EXPECT_NEAR(lowest(result_.clip, target_roles_), source_height, 0.06);
}

// Where both hands have fingers and the source's move.
TEST_P(RetargetCorpus, FingersBendAsTheSourcesAndPalmsFaceTheSameWay) {
  const retarget::Report& report = result_.report;
  if (report.left_fingers_at_rest || report.right_fingers_at_rest) return;
  const auto line = [](const Clip& clip, const RoleMap& roles, int frame, FingerJoint from,
                       FingerJoint to) {
    const int a = roles.finger_joint(Role::left_fingers, from);
    const int b = roles.finger_joint(Role::left_fingers, to);
    if (a < 0 || b < 0) return Vec3(Vec3::Zero());
    const auto positions = clip.frame_positions(frame);
    return Vec3((positions[at(b)] - positions[at(a)]).cast<double>());
  };
  const auto apart = [&](int frame, FingerJoint from, FingerJoint to) {
    const Vec3 a = line(source_, source_roles_, frame, from, to);
    const Vec3 b = line(result_.clip, target_roles_, frame, from, to);
    return a.norm() > 0 && b.norm() > 0 ? degrees_between(a, b) : 0.0;
  };
  for (int f = 0; f < source_.frame_count(); ++f) {
    for (int finger = 1; finger <= 5; ++finger) {
      const auto which = static_cast<Finger>(finger);
      EXPECT_LT(apart(f, {which, 1}, {which, 2}), 0.1);
      EXPECT_LT(apart(f, {which, 2}, {which, 3}), 0.1);
    }
    EXPECT_LT(apart(f, {Finger::little, 1}, {Finger::index, 1}), 15);
  }
}

INSTANTIATE_TEST_SUITE_P(Captures, RetargetCorpus, testing::ValuesIn(kPairs),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

}  // namespace
}  // namespace krok
