#include "pose/blend_pose.h"

#include <array>
#include <cassert>
#include <cmath>

#include "pose/pose_kernels_internal.h"

namespace krok {

namespace {

using pose_detail::Between;
using pose_detail::Kernels;

// Terms per kernel call, which fit on the stack.
constexpr std::size_t kRound = 16;

float blend_with(const Kernels& kernels, std::span<const BlendTerm> terms,
                 std::span<const PoseBlock> reference, std::span<PoseBlock> pose) {
  assert(reference.size() == pose.size());
  std::array<Between, kRound> round;
  std::size_t count = 0;
  bool first = true;
  for (const BlendTerm& term : terms) {
    assert(static_cast<std::size_t>(term.clip->blocks_per_pose()) == pose.size());
    if (term.weight == 0.0f) continue;
    if (count == kRound) {
      kernels.blend(round.data(), count, {first, false}, reference.data(), pose.size(),
                    pose.data());
      first = false;
      count = 0;
    }
    round[count++] = pose_detail::between_frames(*term.clip, term.time, term.weight);
  }
  return std::sqrt(kernels.blend(round.data(), count, {first, true}, reference.data(), pose.size(),
                                 pose.data()));
}

}  // namespace

float blend_poses(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                  std::span<PoseBlock> pose) {
  return blend_with(pose_detail::best_kernels(), terms, reference, pose);
}

float blend_poses_reference(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                            std::span<PoseBlock> pose) {
  return blend_with(pose_detail::scalar_kernels(), terms, reference, pose);
}

void clear_sum(std::span<PoseBlock> sum) {
  for (PoseBlock& block : sum) block = {};
}

void add_to_sum(std::span<const PoseBlock> pose, float weight, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum) {
  assert(pose.size() == sum.size() && reference.size() == sum.size());
  pose_detail::best_kernels().add(pose.data(), weight, reference.data(), sum.size(), sum.data());
}

float finish_sum(std::span<const PoseBlock> reference, std::span<PoseBlock> sum) {
  assert(reference.size() == sum.size());
  return std::sqrt(pose_detail::best_kernels().blend(nullptr, 0, {false, true}, reference.data(),
                                                     sum.size(), sum.data()));
}

}  // namespace krok
