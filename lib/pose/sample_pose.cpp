#include "pose/sample_pose.h"

#include <algorithm>
#include <cassert>

#include "pose/pose_kernels_internal.h"

namespace krok {

namespace {

void sample_with(const pose_detail::Kernels& kernels, const PackedClip& clip, double time,
                 std::span<PoseBlock> pose) {
  assert(pose.size() == static_cast<std::size_t>(clip.blocks_per_pose()));
  const pose_detail::Between term = pose_detail::between_frames(clip, time, 1.0f);
  if (term.part == 0.0f) {
    std::copy_n(term.before, pose.size(), pose.begin());
  } else {
    kernels.sample(term, pose.size(), pose.data());
  }
}

}  // namespace

void sample_pose(const PackedClip& clip, double time, std::span<PoseBlock> pose) {
  sample_with(pose_detail::best_kernels(), clip, time, pose);
}

void sample_poses(const PackedClip& clip, std::span<const double> times,
                  std::span<PoseBlock> poses) {
  const auto kernels = pose_detail::best_kernels();
  const auto blocks = static_cast<std::size_t>(clip.blocks_per_pose());
  assert(poses.size() == times.size() * blocks);
  for (std::size_t i = 0; i < times.size(); ++i) {
    sample_with(kernels, clip, times[i], poses.subspan(i * blocks, blocks));
  }
}

void sample_pose_reference(const PackedClip& clip, double time, std::span<PoseBlock> pose) {
  sample_with(pose_detail::scalar_kernels(), clip, time, pose);
}

}  // namespace krok
