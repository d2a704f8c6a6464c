// FMA affects the results, so targets without it are disabled: such a machine uses the static
// target below, which is the scalar reference. Only targets that KROK_BEST_VERSION can choose are
// compiled.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin/linear_kernel.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include "core/simd.h"
#include "skin/skin_job_internal.h"
// Requires both.
#include "skin/skin_lanes.inc"

HWY_BEFORE_NAMESPACE();
namespace krok::skin_detail {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA

struct Linear {
  template <int kInfluences>
  static HWY_INLINE bool group(const Job& job, std::size_t v, const Group<std::uint16_t>& group) {
    const Matrix matrix = blended_matrix<kInfluences>(job.palette, group);
    store_three(matrix.point(load_three(job.positions + 3 * v)), job.out_positions + 3 * v);
    if (job.normals != nullptr) {
      const Vector n = load_three(job.normals + 3 * v);
      const Vector normal = job.inverse_transpose ? matrix.normal(n) : matrix.vector(n);
      if (!store_direction(normal, job.out_normals + 3 * v)) return false;
    }
    if (job.tangents != nullptr) {
      Vector t;
      V w;
      hn::LoadInterleaved4(Lanes(), job.tangents + 4 * v, t.x, t.y, t.z, w);
      if (job.inverse_transpose) w = hn::Mul(w, matrix.handedness());
      if (!store_direction(matrix.vector(t), w, job.out_tangents + 4 * v)) return false;
    }
    return true;
  }

  template <int kInfluences>
  static HWY_NOINLINE void run(const Job& job, std::size_t begin, const Run& run) {
    Group<std::uint16_t> vertices{job.influences.joints + run.first,
                                  job.influences.weights + run.first, run.influences};
    for (std::size_t v = begin; v < run.end; v += kLanes) {
      if (HWY_UNLIKELY(!group<kInfluences>(job, v, vertices))) linear_scalar(job, v, v + kLanes);
      vertices.advance();
    }
  }
};

void linear(const Job& job, std::size_t begin, std::size_t end) {
  each_run<Linear>(job, begin, end);
}

#else

void linear(const Job& job, std::size_t begin, std::size_t end) {
  linear_scalar(job, begin, end);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::skin_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::skin_detail {

void linear_simd(const Job& job, std::size_t begin, std::size_t end) {
  KROK_BEST_VERSION(linear)(job, begin, end);
}

}  // namespace krok::skin_detail

#endif  // HWY_ONCE
