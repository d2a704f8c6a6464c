// Would fail if playing or blending took memory in its inner calls: every operator new of this
// program is counted.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "pose/blend_pose.h"
#include "pose/local_to_model.h"
#include "pose/sample_pose.h"
#include "poses.h"

namespace {

std::atomic<long> allocations{0};

// Not inlined, so that the compiler sees no pair of an allocation and another's release.
[[gnu::noinline]] void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) std::abort();
  return memory;
}

[[gnu::noinline]] void release(void* memory) {
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size == 0 ? 1 : size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size == 0 ? 1 : size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}

namespace krok {
namespace {

TEST(Allocation, IsCounted) {
  const long before = allocations;
  const std::vector<PoseBlock> blocks(3);
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
  const auto weights = pack_weights(std::vector<float>(60, 0.5f));
  std::vector<PoseBlock> scratch(static_cast<std::size_t>(model_scratch(60)));
  std::vector<Vec3f> positions(times.size() * 60);
  std::vector<Quatf> orientations(positions.size());
  std::vector<JointMatrix> matrices(positions.size());

  const long before = allocations;
  sample_pose(packed, 0.33, pose);
  sample_poses(packed, times, poses);
  blend_poses(terms, reference, pose);
  clear_sum(pose);
  add_to_sum(packed.frame(3), 0.5f, reference, pose);
  add_to_sum(packed.frame(4), 0.5f, weights, reference, pose);
  finish_sum(reference, pose);
  local_to_model({clip.skeleton.parents, poses, scratch}, positions, orientations);
  local_to_model({clip.skeleton.parents, poses, scratch}, matrices);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace krok
