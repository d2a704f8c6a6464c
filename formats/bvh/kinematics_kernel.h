#pragma once

#include <cstddef>

// Interface between Kinematics and its vectorised kernel: plain pointers and numbers. No inline
// functions here: the kernel is compiled for several instruction sets, and the linker may keep a
// copy of an inline function that the CPU cannot run.

namespace krok::bvh::kinematics_detail {

inline constexpr std::size_t kFramesAtOnce = 16;

// One channel of a joint. `factor` converts to metres or degrees, including the sign of the axis.
struct Step {
  std::size_t channel;
  bool is_position;
  int axis;  // Krok's, 0 to 2
  double factor;
};

struct Job {
  const int* parents;  // -1 for the root
  std::size_t joints;
  const double* base;  // [joints x 3]
  const Step* steps;
  const std::size_t* step_begins;  // [joints + 1]
  double root[7];                  // parent frame of the root: position, x, y, z, w
  double* scratch;                 // [joints x 7 x kFramesAtOnce], aligned to 64 bytes
  double farthest;                 // at most the largest float
};

// Poses of up to kFramesAtOnce frames, one frame per lane: `values` has shape
// [channels x kFramesAtOnce], 64-byte aligned, all finite. Stores joint_to_world of the first
// `frames` as floats, [frames x joints x 3] positions and [frames x joints x 4] orientations
// (x, y, z, w). Returns false if a position may be farther from the origin than `farthest`, or an
// angle exceeds kFarthestAngle.
bool poses(const Job& job, const double* values, std::size_t frames, float* positions,
           float* orientations);

// Scalar reference implementation, bit-identical.
bool poses_scalar(const Job& job, const double* values, std::size_t frames, float* positions,
                  float* orientations);

// Scalar reference for one frame, whose values are `stride` apart; stores position and x, y, z, w
// of each joint, [joints x 7].
void pose_scalar(const Job& job, const double* values, std::size_t stride, double* joints);

}  // namespace krok::bvh::kinematics_detail
