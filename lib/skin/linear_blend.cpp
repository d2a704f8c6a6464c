#include "skin/linear_blend.h"

#include <cassert>

#include "skin/skin_job_internal.h"

namespace krok {

namespace {

skin_detail::Job job_of(std::span<const SkinMatrix> palette, const SkinVertices& in,
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

}  // namespace

SkinVertices skin_vertices(const Model& model) {
  return {model.positions, model.normals, model.influences_per_vertex, model.influence_joints,
          model.influence_weights};
}

void linear_blend_reference(std::span<const SkinMatrix> palette, const SkinVertices& in,
                            SkinnedVertices out) {
  skin_detail::linear_scalar(job_of(palette, in, out), 0, in.positions.size());
}

void linear_blend(std::span<const SkinMatrix> palette, const SkinVertices& in,
                  SkinnedVertices out) {
  skin_detail::linear_simd(job_of(palette, in, out), 0, in.positions.size());
}

void linear_blend_parallel(std::span<const SkinMatrix> palette, const SkinVertices& in,
                           SkinnedVertices out, int jobs) {
  skin_detail::over_tiles(skin_detail::linear_simd, job_of(palette, in, out), in.positions.size(),
                          jobs);
}

}  // namespace krok
