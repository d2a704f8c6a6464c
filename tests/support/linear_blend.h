#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "math/transform.h"
#include "scene/model.h"
#include "skin/palette.h"
#include "skin/skin_job_internal.h"

// Linear blend skinning on plain arrays, by the kernel of skin() in lib/skin and by its scalar
// reference, which must give the same bytes. The formula is in skin.h.

namespace krok::test {

// The input. Nothing is owned, nothing may overlap the output.
struct SkinVertices {
  std::span<const Vec3f> positions;       // [vertices], metres, in the reference pose
  std::span<const Vec3f> normals;         // [vertices] or empty; any length
  int influences_per_vertex = 4;          // 1 .. Model::kMaxInfluences
  std::span<const std::uint16_t> joints;  // [vertices x influences_per_vertex], all in the palette
  std::span<const float> weights;         // the same shape
};

// Views of the vertices of a model.
inline SkinVertices skin_vertices(const Model& model) {
  return {model.positions, model.normals, model.influences_per_vertex, model.influence_joints,
          model.influence_weights};
}

// The output. Normals are empty exactly if the input's are.
struct SkinnedVertices {
  std::span<Vec3f> positions;  // [vertices]
  std::span<Vec3f> normals;    // [vertices] or empty; unit
};

inline skin_detail::Job job_of(std::span<const SkinMatrix> palette, const SkinVertices& in,
                               const SkinnedVertices& out) {
  [[maybe_unused]] const std::size_t count = in.positions.size();
  assert(in.influences_per_vertex >= 1);
  assert(in.joints.size() == count * static_cast<std::size_t>(in.influences_per_vertex));
  assert(in.weights.size() == in.joints.size());
  assert(in.normals.empty() || in.normals.size() == count);
  assert(out.positions.size() == count && out.normals.size() == in.normals.size());
  const auto floats = [](auto span) { return span.empty() ? nullptr : span.data()->data(); };
  skin_detail::Job job;
  job.influences.joints = in.joints.data();
  job.influences.weights = in.weights.data();
  job.influences.influences = static_cast<std::size_t>(in.influences_per_vertex);
  job.palette = palette.data();
  job.positions = floats(in.positions);
  job.normals = floats(in.normals);
  job.out_positions = floats(out.positions);
  job.out_normals = floats(out.normals);
  return job;
}

inline void linear_blend_reference(std::span<const SkinMatrix> palette, const SkinVertices& in,
                                   SkinnedVertices out) {
  skin_detail::linear_scalar(job_of(palette, in, out), 0, in.positions.size());
}

inline void linear_blend(std::span<const SkinMatrix> palette, const SkinVertices& in,
                         SkinnedVertices out) {
  skin_detail::linear_simd(job_of(palette, in, out), 0, in.positions.size());
}

// In tiles of vertices on up to `jobs` threads (0: one per core).
inline void linear_blend_parallel(std::span<const SkinMatrix> palette, const SkinVertices& in,
                                  SkinnedVertices out, int jobs) {
  skin_detail::over_tiles(skin_detail::linear_simd, job_of(palette, in, out), in.positions.size(),
                          jobs);
}

}  // namespace krok::test
