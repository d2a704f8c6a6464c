#pragma once

#include <cstddef>

#include "pose/packed_pose.h"

// Shared by the scalar references and the SIMD kernels: plain pointers and numbers. No inline
// functions here: the kernels are compiled for several instruction sets, and the linker keeps one
// copy of an inline function, possibly one that the machine cannot run.
//
// Kernel and reference use the same multiply-adds, fused alike and in the same order, and so give
// the same bits.

namespace krok::pose_detail {

// An interpolated pose, (1 - part) of one frame and `part` of the other, with a blend weight.
struct Between {
  const PoseBlock* before;
  const PoseBlock* after;
  float part;
  float weight;
};

// Below this squared length a sum of rotations has no direction.
inline constexpr float kMinSquare = 1e-12f;

// Allows summing terms in several rounds.
struct Round {
  bool first;  // starts at zero, otherwise continues `sum`
  bool last;   // normalises the rotations
};

// `blend` returns the smallest squared length of a sum of rotations, 0 for one without direction,
// in the last round; 1 in other rounds.
struct Kernels {
  void (*sample)(const Between& term, std::size_t blocks, PoseBlock* pose);
  float (*blend)(const Between* terms, std::size_t count, Round round, const PoseBlock* reference,
                 std::size_t blocks, PoseBlock* sum);
  void (*add)(const PoseBlock* pose, float weight, const PoseBlock* reference, std::size_t blocks,
              PoseBlock* sum);
};

// The scalar reference, and the best kernels for this machine.
Kernels scalar_kernels();
Kernels best_kernels();

// Shared by the scalar reference and the SIMD kernel of local_to_model(); see
// pose_kernels_internal.h.

struct ModelJob {
  const int* parents;
  std::size_t joints;
  const PoseBlock* poses;
  std::size_t count;  // number of poses
  PoseBlock* scratch;
  // Outputs, [count x joints]: either the first two or the last.
  float* positions;     // x, y, z
  float* orientations;  // x, y, z, w
  JointMatrix* matrices;
};

void local_to_model_scalar(const ModelJob& job);
void local_to_model_simd(const ModelJob& job);

// The two frames around a time, clamped to the clip, and the interpolation factor between them.
Between between_frames(const PackedClip& clip, double time, float weight);

}  // namespace krok::pose_detail
