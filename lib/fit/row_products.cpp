#include "fit/joint_rows_internal.h"

// Compiles only targets that KROK_BEST_VERSION can choose.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/row_products.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::fit::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Adds four rows from index i on, one vector at a time while it fits into n; returns the end index.
// Elements are independent and nothing is fused, so the result does not depend on the vector size.
template <class D>
HWY_INLINE std::size_t add_four(D d, const double* f, const double* rows, std::size_t n,
                                std::size_t i, double* to) {
  const auto f0 = hn::Set(d, f[0]), f1 = hn::Set(d, f[1]), f2 = hn::Set(d, f[2]),
             f3 = hn::Set(d, f[3]);
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    const double* from = rows + i;
    const auto first =
        hn::Add(hn::Mul(f0, hn::LoadU(d, from)), hn::Mul(f1, hn::LoadU(d, from + n)));
    const auto second =
        hn::Add(hn::Mul(f2, hn::LoadU(d, from + 2 * n)), hn::Mul(f3, hn::LoadU(d, from + 3 * n)));
    hn::StoreU(hn::Add(hn::LoadU(d, to + i), hn::Add(first, second)), d, to + i);
  }
  return i;
}

// Four rows at a time, so that the sum is loaded and stored less often.
void add_rows(const double* factors, std::size_t stride, const double* rows, std::size_t count,
              std::size_t n, double* to) {
  std::size_t r = 0;
  for (; r + 4 <= count; r += 4) {
    const double f[4] = {factors[r * stride], factors[(r + 1) * stride], factors[(r + 2) * stride],
                         factors[(r + 3) * stride]};
    std::size_t i = add_four(hn::CappedTag<double, 8>(), f, rows + r * n, n, 0, to);
    i = add_four(hn::CappedTag<double, 4>(), f, rows + r * n, n, i, to);
    i = add_four(hn::CappedTag<double, 2>(), f, rows + r * n, n, i, to);
    add_four(hn::CappedTag<double, 1>(), f, rows + r * n, n, i, to);
  }
  for (; r < count; ++r) {
    for (std::size_t i = 0; i < n; ++i) to[i] += factors[r * stride] * rows[r * n + i];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace krok::fit::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::fit::detail {

void add_products(const double* factors, std::size_t stride, const double* rows, std::size_t count,
                  std::size_t n, double* to) {
  const auto best = KROK_BEST_VERSION(add_rows);
  best(factors, stride, rows, count, n, to);
}

}  // namespace krok::fit::detail

#endif  // HWY_ONCE
