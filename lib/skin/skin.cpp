#include "skin/skin.h"

#include <cassert>

#include "skin/binding_internal.h"

namespace krok {

namespace {

using skin_detail::Job;

Job job_of(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
           const SkinnedSurface& out) {
  [[maybe_unused]] const std::size_t count = binding.vertex_count();
  assert(pose.data().binding == &binding.data());
  assert(in.positions.size() == count && out.positions.size() == count);
  assert(in.normals.empty() || in.normals.size() == count);
  assert(in.tangents.empty() || in.tangents.size() == count);
  assert(out.normals.size() == in.normals.size() && out.tangents.size() == in.tangents.size());
  const auto floats = [](auto span) { return span.empty() ? nullptr : span.data()->data(); };
  const skin_detail::Posed& posed = pose.data();
  Job job;
  job.influences = binding.data().influences();
  const bool by_motions = binding.method() == SkinMethod::dual_quaternion;
  if (by_motions) job.motions = posed.pair_motions.data();
  if (!by_motions || !posed.is_rigid) job.palette = posed.palette.data();
  job.inverse_transpose = !posed.is_rigid;
  job.positions = floats(in.positions);
  job.normals = floats(in.normals);
  job.tangents = floats(in.tangents);
  job.out_positions = floats(out.positions);
  job.out_normals = floats(out.normals);
  job.out_tangents = floats(out.tangents);
  return job;
}

}  // namespace

SkinSurface skin_surface(const Model& model) {
  return {model.positions, model.normals, model.tangents};
}

void skin(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
          const SkinnedSurface& out, int jobs) {
  const auto kernel = binding.method() == SkinMethod::dual_quaternion
                          ? skin_detail::dual_quaternion_simd
                          : skin_detail::linear_simd;
  skin_detail::over_tiles(kernel, job_of(binding, pose, in, out), binding.vertex_count(), jobs);
}

void skin_reference(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                    const SkinnedSurface& out) {
  const auto reference = binding.method() == SkinMethod::dual_quaternion
                             ? skin_detail::dual_quaternion_scalar
                             : skin_detail::linear_scalar;
  reference(job_of(binding, pose, in, out), 0, binding.vertex_count());
}

}  // namespace krok
