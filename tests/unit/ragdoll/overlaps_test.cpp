// If these fail, krok-lint --self-intersection misses hands in the trunk, or blames usual motions.

#include "ragdoll/overlaps.h"

#include <gtest/gtest.h>

#include "core/index.h"
#include "motion/local_motion.h"
#include "samples/generator/walk.h"

namespace krok::ragdoll_test {
namespace {

using ragdoll::Overlap;
using ragdoll::Shape;

constexpr double kLimit = 0.07;

TEST(Overlaps, DistancesToShapesAreNegativeInside) {
  Shape box;
  box.half = {1, 2, 3};
  EXPECT_DOUBLE_EQ(signed_distance(box, {0.5, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(signed_distance(box, {4, 6, 0}), 5);
  const Shape capsule{Shape::Kind::capsule, Vec3::Zero(), 0.5, 1};
  EXPECT_DOUBLE_EQ(signed_distance(capsule, {0.2, 0.9, 0}), -0.3);
  EXPECT_DOUBLE_EQ(signed_distance(capsule, {0, 2, 0}), 0.5);
}

// The forearm is bent into the trunk for half a second, with a touch less for an instant.
TEST(Overlaps, AHandInTheTrunkIsOneStretchAndAWalkHasNone) {
  auto made = samples::make_walk({});
  ASSERT_TRUE(made.ok());
  Clip& clip = made->clip;
  const auto bodies = ragdoll::make_bodies(clip.skeleton, find_roles(clip.skeleton));
  ASSERT_TRUE(bodies.ok());
  EXPECT_TRUE(find_overlaps(clip, *bodies, kLimit).empty());
  const int first = 40, last = 70;
  const std::size_t joints = at(clip.joint_count());
  const std::size_t hand = at(clip.skeleton.find("LeftHand")), hips = 0;
  for (int f = first; f <= last; ++f) {
    if (f == 55) continue;
    const Vec3f inside = clip.positions[at(f) * joints + hips] + Vec3f(0, 0.05F, 0);
    clip.positions[at(f) * joints + hand] = inside;
  }
  const auto found = find_overlaps(clip, *bodies, kLimit);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ((*bodies)[at(found[0].second)].name, "left_hand");
  EXPECT_EQ(found[0].first_frame, first);
  EXPECT_EQ(found[0].last_frame, last);
  EXPECT_GT(found[0].depth, kLimit);
}

}  // namespace
}  // namespace krok::ragdoll_test
