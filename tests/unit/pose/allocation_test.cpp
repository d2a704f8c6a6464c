// Would fail if playing or blending took memory in its inner calls: every operator new of this
// program is counted.

#include <gtest/gtest.h>

#include "pose/packed_pose.h"
#include "poses.h"
#include "support/counted_allocations.h"

namespace krok {
namespace {

using test::allocations;

TEST(Allocation, IsCounted) {
  const long before = allocations;
  // A call, not an expression, which compilers may leave out.
  ::operator delete(::operator new(3));
  EXPECT_GT(allocations, before);
}

TEST(Allocation, NoneWhileSamplingBlendingAndPlacing) {
  const Clip clip = test::random_clip(60, 30, 1u);
  const PackedClip packed = pack_clip(clip);
  const auto reference = packed_reference(clip.skeleton);
  const std::size_t blocks = reference.size();
  std::vector<double> times(18);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = 0.05 * static_cast<double>(i);
  std::vector<BlendTerm> terms;
  for (const double time : times) terms.push_back({&packed, time, 1.0f / 18});
  std::vector<PoseBlock> poses(times.size() * blocks), pose(blocks);
  std::vector<PoseBlock> scratch(static_cast<std::size_t>(model_scratch(60)));
  std::vector<Vec3f> positions(times.size() * 60);
  std::vector<Quatf> orientations(positions.size());
  std::vector<JointMatrix> matrices(positions.size());

  const long before = allocations;
  sample_pose(packed, 0.33, pose);
  for (std::size_t i = 0; i < times.size(); ++i) {
    sample_pose(packed, times[i], std::span(poses).subspan(i * blocks, blocks));
  }
  blend_poses(terms, reference, pose);
  clear_sum(pose);
  add_to_sum(packed.frame(3), 0.5f, reference, pose);
  finish_sum(reference, pose);
  local_to_model({clip.skeleton.parents, poses, scratch}, positions, orientations);
  local_to_model({clip.skeleton.parents, poses, scratch}, matrices);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace krok
