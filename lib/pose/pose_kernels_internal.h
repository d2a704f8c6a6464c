#pragma once

#include <cstddef>

#include "pose/packed_pose.h"

// What the scalar references and the SIMD kernels share: plain pointers and numbers. No inline
// functions here: the kernels are compiled for several instruction sets, and the linker keeps one
// copy of an inline function, perhaps one that the machine cannot run.
//
// Kernel and reference do the same multiply-adds, fused alike and in the same order, so that they
// give the same bits.

namespace krok::pose_detail {

// A pose between two frames: (1 - part) of one and `part` of the other, with a weight in a blend.
struct Between {
  const PoseBlock* before;
  const PoseBlock* after;
  float part;
  float weight;
};

// Under this square of its length a sum of rotations has no direction.
inline constexpr float kMinSquare = 1e-12f;

// Where a sum comes from and goes to, so that it can be made in several rounds of terms.
struct Round {
  bool first;  // begins at zero, otherwise at what `sum` holds
  bool last;   // brings the rotations to length 1
};

// Those that give a number give the least square of the length that a sum of rotations had; 0 for
// what has no direction. Only last rounds do, others give 1.
struct Kernels {
  void (*sample)(const Between& term, std::size_t blocks, PoseBlock* pose);
  float (*blend)(const Between* terms, std::size_t count, Round round, const PoseBlock* reference,
                 std::size_t blocks, PoseBlock* sum);
  // `joint_weights`, [blocks x PoseBlock::kLanes], may be null.
  void (*add)(const PoseBlock* pose, float weight, const float* joint_weights,
              const PoseBlock* reference, std::size_t blocks, PoseBlock* sum);
};

// The scalar reference, and the best for this machine.
Kernels scalar_kernels();
Kernels best_kernels();

}  // namespace krok::pose_detail
