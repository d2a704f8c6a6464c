// Captured people of several exporters, played on by powered bodies. If these fail, motors follow
// generated walks alone: forearms that twist, collar bones that rise, feet beside the ground and
// limbs that touch are in captures only.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/file.h"
#include "corpus/bvh/corpus_files.h"
#include "formats/bvh/bvh_reader.h"
#include "ik/anatomical_limits.h"
#include "ragdoll/simulate.h"
#include "support/this_build.h"

namespace krok::ragdoll {
namespace {

class PoweredCaptures : public testing::TestWithParam<const char*> {};

// Within 5 degrees RMS with the root animated, and also where it is only held to the motion.
TEST_P(PoweredCaptures, FollowTheMotion) {
  const std::string path = std::string(test::corpus_folder() + "/bvh/") + GetParam();
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder();
  const auto file = InputFile::open(path);
  ASSERT_TRUE(file.ok());
  const auto capture = bvh::read(file->text(), path, {});
  ASSERT_TRUE(capture.ok());
  const Clip& clip = capture->clip;
  const RoleMap roles = find_roles(clip.skeleton);
  auto bodies = make_bodies(clip.skeleton, roles);
  ASSERT_TRUE(bodies.ok()) << bodies.error().message;
  for (Body& body : *bodies) body.mode = BodyMode::powered;
  FallOptions options;
  options.at = 0.1;  // some begin with a rest frame
  options.duration = std::min(6.0, clip.duration() - options.at);
  options.surroundings.level = true;
  for (const double hold : {1.0, 0.5}) {
    bodies->front().mode = hold < 1 ? BodyMode::powered : BodyMode::animated;
    bodies->front().strength = hold;
    const auto fall =
        simulate_fall(clip, roles, *bodies, ik::anatomical_limits(clip.skeleton, roles), options);
    ASSERT_TRUE(fall.ok()) << fall.error().message;
    EXPECT_LT(fall->mean_off, 5 * kRadiansPerDegree) << hold;
    EXPECT_LT(fall->largest.penetration, 0.005) << hold;
    EXPECT_LT(fall->largest.joint_gap, 1e-6) << hold;
    RecordProperty(hold < 1 ? "held" : "animated",
                   std::to_string(fall->mean_off / kRadiansPerDegree));
  }
}

INSTANTIATE_TEST_SUITE_P(People, PoweredCaptures,
                         testing::Values("walkset_cmu07/007_03.bvh", "walkset_cmu07/007_10.bvh",
                                         "pybvh/cmu_12_01_walk.bvh",
                                         "optitrack_arena_bvh-matlab/walk.bvh",
                                         "makehuman/12_03.bvh", "makehuman/02_02.bvh",
                                         "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh",
                                         "animated_drawings/rokoko_jesse_dance.bvh",
                                         "animated_drawings/fair1_zombie.bvh",
                                         "animated_drawings/cmu1_jumping_jacks.bvh"),
                         test::name_of_file);

}  // namespace
}  // namespace krok::ragdoll
