// FMA affects the results, so targets without it are disabled: such a machine uses the static
// target below, which is the scalar reference. Only targets that KROK_BEST_VERSION can choose are
// compiled.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin/dual_quaternion_kernel.cpp"
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

// The blended dual quaternions of kLanes vertices.
struct Motion {
  Vector r, d;
  V rw, dw;

  HWY_INLINE bool normalize() {
    const V square =
        hn::MulAdd(r.x, r.x, hn::MulAdd(r.y, r.y, hn::MulAdd(r.z, r.z, hn::Mul(rw, rw))));
    if (HWY_UNLIKELY(!all_regular(square))) return false;
    const V scale = inverse_length(square);
    r = scaled(scale, r);
    d = scaled(scale, d);
    rw = hn::Mul(rw, scale);
    dw = hn::Mul(dw, scale);
    return true;
  }

  // r x v + w v; the rotation adds 2 r x (this) to v.
  HWY_INLINE Vector half_way(const Vector& v) const {
    const Vector c = cross(r, v);
    return {hn::MulAdd(rw, v.x, c.x), hn::MulAdd(rw, v.y, c.y), hn::MulAdd(rw, v.z, c.z)};
  }
  HWY_INLINE Vector vector(const Vector& v) const {
    const Vector c = cross(r, half_way(v));
    const V two = number(2.0f);
    return {hn::MulAdd(two, c.x, v.x), hn::MulAdd(two, c.y, v.y), hn::MulAdd(two, c.z, v.z)};
  }
  HWY_INLINE Vector point(const Vector& p) const {
    const Vector u = half_way(p);
    const Vector c = cross(r, {hn::Add(u.x, d.x), hn::Add(u.y, d.y), hn::Add(u.z, d.z)});
    const auto moved = [&](V from, V turn, V di, V ri) HWY_ATTR {
      return hn::MulAdd(number(2.0f), hn::NegMulAdd(dw, ri, hn::MulAdd(rw, di, turn)), from);
    };
    return {moved(p.x, c.x, d.x, r.x), moved(p.y, c.y, d.y, r.y), moved(p.z, c.z, d.z, r.z)};
  }
};

struct DualQuaternions {
  template <int kInfluences>
  static HWY_INLINE bool group(const Job& job, std::size_t v, const Group<std::uint32_t>& pairs,
                               const Group<std::uint16_t>& joints) {
    Column parts[2];
    blended_columns<2, kInfluences>(job.motions->components, pairs, parts);
    Motion motion{{parts[0].x, parts[0].y, parts[0].z},
                  {parts[1].x, parts[1].y, parts[1].z},
                  parts[0].w,
                  parts[1].w};
    if (!motion.normalize()) return false;
    const bool deforms = job.palette != nullptr;
    Matrix matrix;
    if (deforms) matrix = blended_matrix<kInfluences>(job.palette, joints);
    const Vector p = load_three(job.positions + 3 * v);
    store_three(motion.point(deforms ? matrix.point(p) : p), job.out_positions + 3 * v);
    if (job.normals != nullptr) {
      const Vector n = load_three(job.normals + 3 * v);
      const Vector normal = motion.vector(deforms ? matrix.normal(n) : n);
      if (!store_direction(normal, job.out_normals + 3 * v)) return false;
    }
    if (job.tangents != nullptr) {
      Vector t;
      V w;
      hn::LoadInterleaved4(Lanes(), job.tangents + 4 * v, t.x, t.y, t.z, w);
      if (deforms) w = hn::Mul(w, matrix.handedness());
      const Vector tangent = motion.vector(deforms ? matrix.vector(t) : t);
      if (!store_direction(tangent, w, job.out_tangents + 4 * v)) return false;
    }
    return true;
  }

  template <int kInfluences>
  static HWY_NOINLINE void run(const Job& job, std::size_t begin, const Run& run) {
    const Influences& all = job.influences;
    Group<std::uint32_t> pairs{all.pairs + run.first, all.weights + run.first, run.influences};
    Group<std::uint16_t> joints{all.joints + run.first, all.weights + run.first, run.influences};
    for (std::size_t v = begin; v < run.end; v += kLanes) {
      if (HWY_UNLIKELY(!group<kInfluences>(job, v, pairs, joints))) {
        dual_quaternion_scalar(job, v, v + kLanes);
      }
      pairs.advance();
      joints.advance();
    }
  }
};

void dual_quaternion(const Job& job, std::size_t begin, std::size_t end) {
  each_run<DualQuaternions>(job, begin, end);
}

#else

void dual_quaternion(const Job& job, std::size_t begin, std::size_t end) {
  dual_quaternion_scalar(job, begin, end);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::skin_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::skin_detail {

void dual_quaternion_simd(const Job& job, std::size_t begin, std::size_t end) {
  KROK_BEST_VERSION(dual_quaternion)(job, begin, end);
}

}  // namespace krok::skin_detail

#endif  // HWY_ONCE
