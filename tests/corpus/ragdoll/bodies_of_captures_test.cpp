// Every capture of the corpus as a body that falls. If these fail, krok-ragdoll refuses skeletons
// of some exporter, its bodies do not fill the mesh, or real poses and speeds tear it apart.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "body/body.h"
#include "core/file.h"
#include "corpus/bvh/corpus_files.h"
#include "formats/bvh/bvh_reader.h"
#include "ik/anatomical_limits.h"
#include "ragdoll/simulate.h"
#include "retarget/stance.h"
#include "support/this_build.h"

namespace krok {
namespace {

constexpr std::size_t kParts = 6;  // tests, which run beside each other

std::vector<std::string> captures() {
  std::vector<std::string> found;
  if (!std::filesystem::exists(test::kBvhFolder)) return found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::kBvhFolder)) {
    if (entry.path().extension() == ".bvh") found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

ragdoll::Fall fall_of(const Clip& clip, const RoleMap& roles,
                      const std::vector<ragdoll::Body>& bodies) {
  ragdoll::FallOptions options;
  options.at = 0.5 * clip.duration();
  options.duration = 1;
  options.surroundings.level = true;
  // Captures stand on y = 0 only roughly; what is below at the begin is the capture's matter.
  Vec3f low = clip.frame_positions(0)[0];
  for (const Vec3f& place : clip.frame_positions(clip.frame_count() / 2)) low = low.cwiseMin(place);
  options.surroundings.height = low.y() - 0.05;
  auto fall = ragdoll::simulate_fall(
      clip, roles, bodies, ik::anatomical_limits(retarget::neutral_skeleton(clip, roles), roles),
      options);
  EXPECT_TRUE(fall.ok()) << (fall.ok() ? "" : fall.error().message);
  return fall.ok() ? std::move(*fall) : ragdoll::Fall();
}

class BodiesOfCaptures : public testing::TestWithParam<std::size_t> {};

TEST_P(BodiesOfCaptures, FillTheMeshAndFall) {
  const auto files = captures();
  if (files.empty()) GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder();
  int persons = 0;
  std::set<std::vector<std::string>> known;
  for (std::size_t i = GetParam(); i < files.size(); i += kParts) {
    const std::string& path = files[i];
    SCOPED_TRACE(path);
    const auto file = InputFile::open(path);
    ASSERT_TRUE(file.ok());
    const auto capture = bvh::read(file->text(), path, {});
    ASSERT_TRUE(capture.ok());
    const Clip& clip = capture->clip;
    if (!known.insert(clip.skeleton.names).second) continue;
    const RoleMap roles = find_roles(clip.skeleton);
    const auto mesh = make_body(clip, {.detail = BodyDetail::low});
    ASSERT_TRUE(mesh.ok());
    ragdoll::BodyOptions options;
    options.model = &mesh->model;
    const auto bodies = ragdoll::make_bodies(clip.skeleton, roles, options);
    EXPECT_TRUE(bodies.ok()) << bodies.error().message;
    if (!roles.humanoid) continue;
    ++persons;
    EXPECT_GE(ragdoll::covered_share(mesh->model, *bodies, 0.03), 0.9);
    if (clip.frame_count() == 0) continue;
    const ragdoll::Fall fall = fall_of(clip, roles, *bodies);
    EXPECT_LT(fall.largest.joint_gap, 1e-4);
    EXPECT_LT(fall.largest.limit_excess, 1 * kRadiansPerDegree);
    EXPECT_LT(fall.largest.penetration, 0.005);
  }
  EXPECT_GE(persons, 3);
}

INSTANTIATE_TEST_SUITE_P(Parts, BodiesOfCaptures, testing::Range<std::size_t>(0, kParts));

}  // namespace
}  // namespace krok
