#pragma once

#include <cstddef>
#include <cstdint>

// What Kinematics and its vectorised kernel share, as plain pointers and numbers. No inline
// functions here: the kernel is compiled for several instruction sets, and the linker keeps one
// copy of an inline function, perhaps one that the machine cannot run.

namespace krok::bvh::kinematics_detail {

inline constexpr std::size_t kFramesAtOnce = 16;

// One channel that moves its joint. `factor`: to metres or degrees, with the axis's sign.
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
  double root[7];                  // the frame that the root stands in: position, x, y, z, w
  double* scratch;                 // [joints x 7 x kFramesAtOnce], aligned to 64 bytes
  double farthest;                 // no more than the largest float
};

// Poses of up to kFramesAtOnce frames, frames as lanes: `values` has [channels x kFramesAtOnce]
// doubles on a 64-byte boundary, all finite. Stores joint_to_world of the first `frames` as floats,
// [frames x joints x 3] positions and [frames x joints x 4] orientations (x, y, z, w). False if
// some position may be farther from the origin than `farthest`, or some angle be beyond
// kFarthestAngle.
bool poses(const Job& job, const double* values, std::size_t frames, float* positions,
           float* orientations);

// The scalar reference: the same bits.
bool poses_scalar(const Job& job, const double* values, std::size_t frames, float* positions,
                  float* orientations);

// The scalar reference for one frame, whose values stand `stride` apart; stores position and
// x, y, z, w of each joint, [joints x 7].
void pose_scalar(const Job& job, const double* values, std::size_t stride, double* joints);

}  // namespace krok::bvh::kinematics_detail
