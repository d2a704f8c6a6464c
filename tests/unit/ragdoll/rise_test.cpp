// If these fail, the sample's motions of getting up go through the ground, slide on what they stand
// on, jerk, or do not lead from lying to where a walk begins.

#include "samples/generator/rise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/get_up.h"
#include "roles/roles.h"
#include "samples/generator/walk.h"

namespace krok::ragdoll {
namespace {

using samples::Lying;

std::vector<Transform> pose_of_frame(const Clip& clip, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  return pose;
}

class SampleRise : public testing::TestWithParam<Lying> {
 protected:
  SampleRise() {
    samples::RiseOptions options;
    options.from = GetParam();
    clip_ = *samples::make_rise(options);
  }
  Vec3 joint(const char* name, int frame) const {
    return clip_.frame_positions(frame)[at(clip_.skeleton.find(name))].cast<double>();
  }
  Clip clip_;
};

TEST_P(SampleRise, StaysOutOfTheGround) {
  const auto bodies = *make_bodies(clip_.skeleton, find_roles(clip_.skeleton));
  const GroundHeight level = [](double, double) { return std::optional<double>(0.0); };
  for (const Body& body : bodies) {
    double deepest = -1;
    int when = 0;
    for (int f = 0; f < clip_.frame_count(); ++f) {
      const double depth = depth_in_ground(body, pose_of_frame(clip_, f), level);
      if (depth > deepest) {
        deepest = depth;
        when = f;
      }
    }
    EXPECT_LT(deepest, 0.008) << body.name << " at " << when / clip_.rate << " s";
  }
}

TEST_P(SampleRise, LeadsFromLyingToWhereAWalkBegins) {
  const int last = clip_.frame_count() - 1;
  EXPECT_LT(joint("Head", 0).y(), 0.35);
  EXPECT_LT(joint("Hips", 0).y(), 0.2);
  samples::WalkOptions options;
  options.steps = 1;
  options.from_standing = true;
  const Clip walk = samples::make_walk(options)->clip;
  const auto stands = pose_of_frame(clip_, last), begins = pose_of_frame(walk, 0);
  for (std::size_t j = 0; j < stands.size(); ++j) {
    EXPECT_LT((stands[j].position - begins[j].position).norm(), 1e-4) << clip_.skeleton.names[j];
    EXPECT_LT(angle_between(stands[j].orientation, begins[j].orientation), 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SampleRise, testing::Values(Lying::front, Lying::back, Lying::side));

}  // namespace
}  // namespace krok::ragdoll
