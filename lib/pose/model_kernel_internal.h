#pragma once

#include <cstddef>

#include "pose/local_to_model.h"

// Shared by the scalar reference and the SIMD kernel of local_to_model(); see
// pose_kernels_internal.h.

namespace krok::pose_detail {

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

}  // namespace krok::pose_detail
