#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "skin/palette.h"

// What the scalar reference and the SIMD kernel share: plain pointers, and the rare cases. No
// inline functions here: the kernel is compiled for several instruction sets, and the linker keeps
// one copy of an inline function, perhaps one that the machine cannot run.

namespace krok::linear_blend_detail {

// SkinVertices and SkinnedVertices as pointers to floats, three a vertex; normals may be null.
struct Job {
  const SkinMatrix* palette;
  const float* positions;
  const float* normals;
  const std::uint16_t* joints;
  const float* weights;
  std::size_t influences;
  float* out_positions;
  float* out_normals;
};

// The squares of lengths between which a vector can be brought to length 1. NaN is outside.
inline constexpr float kMinLengthSquared = 1e-30f;
inline constexpr float kMaxLengthSquared = 1e30f;

// The reference for vertices [begin, end).
void blend_scalar(const Job& job, std::size_t begin, std::size_t end);

// Brings out_normals of vertices [begin, end) to length 1, in place.
void normalize_scalar(const Job& job, std::size_t begin, std::size_t end);

}  // namespace krok::linear_blend_detail
