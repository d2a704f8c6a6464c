#include "rbf/evaluate_internal.h"

// Results depend on fused multiply-add, so targets without it are disabled: such machines use the
// static target below, which is the scalar reference. Only targets that KROK_BEST_VERSION can
// choose are compiled.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rbf/evaluate_kernel.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::rbf::detail {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kLanes>;
using Integers = hn::RebindToUnsigned<Doubles>;
using V = hn::Vec<Doubles>;
constexpr std::size_t kWidth = hn::MaxLanes(Doubles());

HWY_INLINE V number(double value) {
  return hn::Set(Doubles(), value);
}

HWY_INLINE V exp_of(V x) {
  const Doubles d;
  const Integers u;
  const V rounding = hn::MulAdd(x, number(kLog2E), number(kRounder));
  const V n = hn::Sub(rounding, number(kRounder));
  const V r = hn::MulAdd(n, number(-kLn2Low), hn::MulAdd(n, number(-kLn2High), x));
  V p = number(kInverseFactorials[0]);
  for (int i = 1; i < kExpTerms; ++i) p = hn::MulAdd(p, r, number(kInverseFactorials[i]));
  const auto exponent =
      hn::ShiftLeft<52>(hn::Add(hn::BitCast(u, rounding), hn::Set(u, std::uint64_t{1023})));
  return hn::IfThenElseZero(hn::Ge(x, number(kMinExponent)), hn::Mul(p, hn::BitCast(d, exponent)));
}

// phi and, with kSlopes, its slope, by the squared distance; see basis_scalar().
template <Kernel kKernel, bool kSlopes>
HWY_INLINE void basis(V square, V inverse_square, V& value, V& slope) {
  const Doubles d;
  const V zero = hn::Zero(d);
  const V one = number(1);
  if constexpr (kKernel == Kernel::cubic || kKernel == Kernel::linear) {
    const V r = hn::Sqrt(square);
    if constexpr (kKernel == Kernel::cubic) {
      value = hn::Mul(square, r);
      if constexpr (kSlopes) slope = hn::Mul(number(3), r);
    } else {
      value = r;
      if constexpr (kSlopes) slope = hn::IfThenElseZero(hn::Gt(r, zero), hn::Div(one, r));
    }
    return;
  }
  const V relative = hn::Mul(square, inverse_square);
  if constexpr (kKernel == Kernel::gaussian) {
    value = exp_of(hn::Mul(number(-kGaussian), relative));
    if constexpr (kSlopes) {
      slope = hn::Mul(hn::Mul(number(-2 * kGaussian), inverse_square), value);
    }
    return;
  }
  const V t = hn::Sqrt(relative);
  const V u = hn::IfThenElseZero(hn::Lt(t, one), hn::Sub(one, t));
  const V squared = hn::Mul(u, u);
  if constexpr (kKernel == Kernel::bspline) {
    const auto near = hn::Le(t, number(0.5));
    const V within = hn::MulAdd(hn::Mul(number(6), hn::Mul(t, t)), hn::Sub(t, one), one);
    const V beyond = hn::Mul(hn::Mul(number(2), squared), u);
    value = hn::IfThenElse(near, within, beyond);
    if constexpr (kSlopes) {
      const V slope_within = hn::Mul(hn::MulAdd(number(18), t, number(-12)), inverse_square);
      const V slope_beyond = hn::Mul(hn::Div(hn::Mul(number(-6), squared), t), inverse_square);
      slope = hn::IfThenElse(near, slope_within, slope_beyond);
    }
  } else {
    const V cube = hn::Mul(squared, u);
    value = hn::Mul(hn::Mul(cube, u), hn::MulAdd(number(4), t, one));
    if constexpr (kSlopes) slope = hn::Mul(hn::Mul(number(-20), cube), inverse_square);
  }
}

template <Kernel kKernel, bool kSlopes>
void basis_chunk(const Job& job, const double* HWY_RESTRICT point, std::size_t first,
                 std::size_t count, double* HWY_RESTRICT values, double* HWY_RESTRICT by_distance) {
  const Doubles d;
  for (std::size_t k = 0; k < count; k += kWidth) {
    V square = hn::Zero(d);
    for (std::size_t i = 0; i < job.dimensions; ++i) {
      const V along =
          hn::Sub(number(point[i]), hn::Load(d, job.places + i * job.centres + first + k));
      square = hn::MulAdd(along, along, square);
    }
    V value = square, slope = square;
    basis<kKernel, kSlopes>(square, hn::Load(d, job.inverse_squares + first + k), value, slope);
    hn::Store(value, d, values + k);
    if constexpr (kSlopes) hn::Store(slope, d, by_distance + k);
  }
}

template <bool kSlopes>
void basis_chunk(const Job& job, const double* point, std::size_t first, std::size_t count,
                 double* values, double* by_distance) {
  const auto run = job.kernel == Kernel::cubic      ? basis_chunk<Kernel::cubic, kSlopes>
                   : job.kernel == Kernel::linear   ? basis_chunk<Kernel::linear, kSlopes>
                   : job.kernel == Kernel::gaussian ? basis_chunk<Kernel::gaussian, kSlopes>
                   : job.kernel == Kernel::bspline  ? basis_chunk<Kernel::bspline, kSlopes>
                                                    : basis_chunk<Kernel::wendland, kSlopes>;
  run(job, point, first, count, values, by_distance);
}

// Adds to `used` weights of a block that is kBlock wide.
template <std::size_t kBlock>
HWY_INLINE void add_block(const double* HWY_RESTRICT values,
                          const double* HWY_RESTRICT coefficients, std::size_t count,
                          std::size_t used, double* HWY_RESTRICT weights) {
  const hn::CappedTag<double, kBlock> d;
  constexpr std::size_t kStep = hn::MaxLanes(decltype(d)());
  constexpr std::size_t kVectors = kBlock / kStep;
  using Vector = hn::Vec<decltype(d)>;
  HWY_ALIGN double sums[kBlock];
  for (std::size_t v = 0; v < kVectors; ++v) {
    const double* HWY_RESTRICT at = coefficients + v * kStep;
    Vector part0 = hn::Zero(d), part1 = hn::Zero(d), part2 = hn::Zero(d), part3 = hn::Zero(d);
    for (std::size_t k = 0; k < count; k += 4) {
      part0 = hn::MulAdd(hn::Set(d, values[k]), hn::Load(d, at), part0);
      part1 = hn::MulAdd(hn::Set(d, values[k + 1]), hn::Load(d, at + kBlock), part1);
      part2 = hn::MulAdd(hn::Set(d, values[k + 2]), hn::Load(d, at + 2 * kBlock), part2);
      part3 = hn::MulAdd(hn::Set(d, values[k + 3]), hn::Load(d, at + 3 * kBlock), part3);
      at += 4 * kBlock;
    }
    hn::Store(hn::Add(hn::Add(part0, part1), hn::Add(part2, part3)), d, sums + v * kStep);
  }
  for (std::size_t j = 0; j < used; ++j) weights[j] += sums[j];
}

void add_chunk(const Job& job, const double* values, std::size_t first, std::size_t count,
               double* weights) {
  for (std::size_t block = 0; block < job.examples; block += kLanes) {
    const std::size_t used = job.examples - block < kLanes ? job.examples - block : kLanes;
    const double* coefficients = job.coefficients + block * job.centres;
    if (used > 4) {
      add_block<kLanes>(values, coefficients + first * kLanes, count, used, weights + block);
    } else {
      add_block<4>(values, coefficients + first * 4, count, used, weights + block);
    }
  }
}

void begin_with_planes(const Job& job, const double* point, double* weights, double* slopes) {
  const Doubles d;
  const std::size_t stride = (job.examples + kLanes - 1) / kLanes * kLanes;
  HWY_ALIGN double sums[kWidth];
  for (std::size_t block = 0; block < job.examples; block += kWidth) {
    const std::size_t used = job.examples - block < kWidth ? job.examples - block : kWidth;
    const double* affine = job.affine + block;
    V sum = hn::Load(d, affine);
    for (std::size_t i = 0; i < job.dimensions; ++i) {
      const double* slope = affine + (i + 1) * stride;
      sum = hn::MulAdd(number(point[i]), hn::Load(d, slope), sum);
      if (slopes == nullptr) continue;
      for (std::size_t j = 0; j < used; ++j) slopes[i * job.examples + block + j] = slope[j];
    }
    hn::Store(sum, d, sums);
    for (std::size_t j = 0; j < used; ++j) weights[block + j] = sums[j];
  }
}

void evaluate(const Job& job, const double* point, double* weights, double* slopes) {
  const Doubles d;
  begin_with_planes(job, point, weights, slopes);
  HWY_ALIGN double values[kChunk];
  HWY_ALIGN double by_distance[kChunk];
  HWY_ALIGN double directed[kChunk];
  for (std::size_t first = 0; first < job.centres; first += kChunk) {
    const std::size_t left = job.centres - first;
    const std::size_t count = left < kChunk ? left : kChunk;
    if (slopes == nullptr) {
      basis_chunk<false>(job, point, first, count, values, by_distance);
      add_chunk(job, values, first, count, weights);
      continue;
    }
    basis_chunk<true>(job, point, first, count, values, by_distance);
    add_chunk(job, values, first, count, weights);
    for (std::size_t i = 0; i < job.dimensions; ++i) {
      const double* places = job.places + i * job.centres + first;
      for (std::size_t k = 0; k < count; k += kWidth) {
        const V along = hn::Sub(number(point[i]), hn::Load(d, places + k));
        hn::Store(hn::Mul(hn::Load(d, by_distance + k), along), d, directed + k);
      }
      add_chunk(job, directed, first, count, slopes + i * job.examples);
    }
  }
}

#else

void evaluate(const Job& job, const double* point, double* weights, double* slopes) {
  evaluate_scalar(job, point, weights, slopes);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::rbf::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::rbf::detail {

void evaluate_best(const Job& job, const double* point, double* weights, double* slopes) {
  const auto best = KROK_BEST_VERSION(evaluate);
  best(job, point, weights, slopes);
}

}  // namespace krok::rbf::detail

#endif  // HWY_ONCE
