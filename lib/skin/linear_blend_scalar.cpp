#include <cmath>

#include "skin/linear_blend_internal.h"

namespace krok::linear_blend_detail {

namespace {

// One row of column-major `m` times (x, y, z, 1) or (x, y, z, 0), fused from the right.
float row_times_point(const float* m, int row, const float* p) {
  return std::fma(m[row], p[0],
                  std::fma(m[4 + row], p[1], std::fma(m[8 + row], p[2], m[12 + row])));
}
float row_times_vector(const float* m, int row, const float* n) {
  return std::fma(m[row], n[0], std::fma(m[4 + row], n[1], m[8 + row] * n[2]));
}

bool normalize(float* n) {
  const float square = std::fma(n[0], n[0], std::fma(n[1], n[1], n[2] * n[2]));
  if (!(square >= kMinLengthSquared && square <= kMaxLengthSquared)) return false;
  const float scale = 1.0f / std::sqrt(square);
  for (int i = 0; i < 3; ++i) n[i] *= scale;
  return true;
}

}  // namespace

void normalize_scalar(const Job& job, std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    float* n = job.out_normals + 3 * v;
    if (normalize(n)) continue;
    const float* first = job.palette[job.joints[v * job.influences]].elements;
    for (int i = 0; i < 3; ++i) n[i] = row_times_vector(first, i, job.normals + 3 * v);
    if (normalize(n)) continue;
    n[0] = n[2] = 0.0f;
    n[1] = 1.0f;
  }
}

void blend_scalar(const Job& job, std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    const std::uint16_t* joints = job.joints + v * job.influences;
    const float* weights = job.weights + v * job.influences;
    float blended[16];
    for (int e = 0; e < 16; ++e) blended[e] = weights[0] * job.palette[joints[0]].elements[e];
    for (std::size_t k = 1; k < job.influences; ++k) {
      const float* matrix = job.palette[joints[k]].elements;
      for (int e = 0; e < 16; ++e) blended[e] = std::fma(weights[k], matrix[e], blended[e]);
    }
    for (int i = 0; i < 3; ++i) {
      job.out_positions[3 * v + i] = row_times_point(blended, i, job.positions + 3 * v);
    }
    if (job.normals == nullptr) continue;
    for (int i = 0; i < 3; ++i) {
      job.out_normals[3 * v + i] = row_times_vector(blended, i, job.normals + 3 * v);
    }
  }
  if (job.normals != nullptr) normalize_scalar(job, begin, end);
}

}  // namespace krok::linear_blend_detail
