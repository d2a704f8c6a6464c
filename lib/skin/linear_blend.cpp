#include "skin/linear_blend.h"

// Fused arithmetic is part of the result, so targets without it are left out: such a machine takes
// the static target below, which is the scalar reference.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin/linear_blend.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include <algorithm>
#include <cassert>

#include "core/parallel.h"
#include "skin/linear_blend_internal.h"

HWY_BEFORE_NAMESPACE();
namespace krok::linear_blend_detail {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA

namespace hn = hwy::HWY_NAMESPACE;

// As many lanes as the target has, but no more than a matrix has elements.
using Wide = hn::CappedTag<float, 16>;
using Four = hn::FixedTag<float, 4>;

// sum_k w_k P_k into `blended`, 16 floats on a 64-byte boundary.
HWY_INLINE void blend_matrices(const Job& job, std::size_t v, float* HWY_RESTRICT blended) {
  const Wide d;
  constexpr std::size_t kLanes = hn::MaxLanes(Wide());
  constexpr std::size_t kParts = 16 / kLanes;
  const std::uint16_t* HWY_RESTRICT joints = job.joints + v * job.influences;
  const float* HWY_RESTRICT weights = job.weights + v * job.influences;
  hn::Vec<Wide> sum[kParts];
  const auto first = hn::Set(d, weights[0]);
  for (std::size_t part = 0; part < kParts; ++part) {
    sum[part] = hn::Mul(first, hn::Load(d, job.palette[joints[0]].elements + part * kLanes));
  }
  for (std::size_t k = 1; k < job.influences; ++k) {
    const auto weight = hn::Set(d, weights[k]);
    const float* HWY_RESTRICT matrix = job.palette[joints[k]].elements;
    for (std::size_t part = 0; part < kParts; ++part) {
      sum[part] = hn::MulAdd(weight, hn::Load(d, matrix + part * kLanes), sum[part]);
    }
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    hn::Store(sum[part], d, blended + part * kLanes);
  }
}

// Stores three of four lanes; `more` says that a vertex follows, whose place may be written over.
HWY_INLINE void store_three(hn::Vec<Four> value, float* to, bool more) {
  const Four d;
  if (more) {
    hn::StoreU(value, d, to);
  } else {
    HWY_ALIGN float four[4];
    hn::Store(value, d, four);
    to[0] = four[0];
    to[1] = four[1];
    to[2] = four[2];
  }
}

HWY_INLINE void transform(const Job& job, std::size_t begin, std::size_t end) {
  const Four d;
  alignas(64) float blended[16];
  for (std::size_t v = begin; v < end; ++v) {
    blend_matrices(job, v, blended);
    const auto x_axis = hn::Load(d, blended);
    const auto y_axis = hn::Load(d, blended + 4);
    const auto z_axis = hn::Load(d, blended + 8);
    const auto origin = hn::Load(d, blended + 12);
    const float* HWY_RESTRICT p = job.positions + 3 * v;
    const auto position = hn::MulAdd(
        x_axis, hn::Set(d, p[0]),
        hn::MulAdd(y_axis, hn::Set(d, p[1]), hn::MulAdd(z_axis, hn::Set(d, p[2]), origin)));
    store_three(position, job.out_positions + 3 * v, v + 1 < end);
    if (job.normals == nullptr) continue;
    const float* HWY_RESTRICT n = job.normals + 3 * v;
    const auto normal =
        hn::MulAdd(x_axis, hn::Set(d, n[0]),
                   hn::MulAdd(y_axis, hn::Set(d, n[1]), hn::Mul(z_axis, hn::Set(d, n[2]))));
    store_three(normal, job.out_normals + 3 * v, v + 1 < end);
  }
}

HWY_INLINE void normalize(const Job& job, std::size_t begin, std::size_t end) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto one = hn::Set(d, 1.0f);
  std::size_t v = begin;
  for (; v + lanes <= end; v += lanes) {
    float* n = job.out_normals + 3 * v;
    hn::Vec<decltype(d)> x, y, z;
    hn::LoadInterleaved3(d, n, x, y, z);
    const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto regular = hn::And(hn::Ge(square, hn::Set(d, kMinLengthSquared)),
                                 hn::Le(square, hn::Set(d, kMaxLengthSquared)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, regular))) {
      normalize_scalar(job, v, v + lanes);
      continue;
    }
    const auto scale = hn::Div(one, hn::Sqrt(square));
    hn::StoreInterleaved3(hn::Mul(x, scale), hn::Mul(y, scale), hn::Mul(z, scale), d, n);
  }
  normalize_scalar(job, v, end);
}

void blend_range(const Job& job, std::size_t begin, std::size_t end) {
  // Normals are brought to length 1 while they are still in the cache.
  constexpr std::size_t kBlock = 512;
  for (std::size_t block = begin; block < end; block += kBlock) {
    const std::size_t block_end = std::min(block + kBlock, end);
    transform(job, block, block_end);
    if (job.normals != nullptr) normalize(job, block, block_end);
  }
}

#else

void blend_range(const Job& job, std::size_t begin, std::size_t end) {
  blend_scalar(job, begin, end);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::linear_blend_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok {

namespace linear_blend_detail {

HWY_EXPORT(blend_range);

namespace {

Job make_job(std::span<const SkinMatrix> palette, const SkinVertices& in,
             const SkinnedVertices& out) {
  [[maybe_unused]] const std::size_t count = in.positions.size();
  assert(in.influences_per_vertex >= 1);
  assert(in.joints.size() == count * static_cast<std::size_t>(in.influences_per_vertex));
  assert(in.weights.size() == in.joints.size());
  assert(in.normals.empty() || in.normals.size() == count);
  assert(out.positions.size() == count && out.normals.size() == in.normals.size());
  const auto floats = [](auto span) { return span.empty() ? nullptr : span.data()->data(); };
  return {palette.data(),        floats(in.positions),
          floats(in.normals),    in.joints.data(),
          in.weights.data(),     static_cast<std::size_t>(in.influences_per_vertex),
          floats(out.positions), floats(out.normals)};
}

}  // namespace

}  // namespace linear_blend_detail

SkinVertices skin_vertices(const Model& model) {
  return {model.positions, model.normals, model.influences_per_vertex, model.influence_joints,
          model.influence_weights};
}

void linear_blend_reference(std::span<const SkinMatrix> palette, const SkinVertices& in,
                            SkinnedVertices out) {
  linear_blend_detail::blend_scalar(linear_blend_detail::make_job(palette, in, out), 0,
                                    in.positions.size());
}

void linear_blend(std::span<const SkinMatrix> palette, const SkinVertices& in,
                  SkinnedVertices out) {
  using linear_blend_detail::HWY_DISPATCH_TABLE(blend_range);
  HWY_DYNAMIC_DISPATCH(blend_range)
  (linear_blend_detail::make_job(palette, in, out), 0, in.positions.size());
}

void linear_blend_parallel(std::span<const SkinMatrix> palette, const SkinVertices& in,
                           SkinnedVertices out, int jobs) {
  using linear_blend_detail::HWY_DISPATCH_TABLE(blend_range);
  constexpr std::size_t kTile = 2048;  // large enough to be worth a thread's while
  const auto job = linear_blend_detail::make_job(palette, in, out);
  parallel_for(in.positions.size(), kTile, jobs, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(blend_range)(job, begin, end);
  });
}

}  // namespace krok

#endif  // HWY_ONCE
