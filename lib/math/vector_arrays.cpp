#include "math/vector_arrays.h"

// Only targets that KROK_BEST_VERSION can choose are compiled.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "math/vector_arrays.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::vector_arrays_detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using Bits = hn::RebindToUnsigned<Lanes>;
using V = hn::Vec<Lanes>;
using VBits = hn::Vec<Bits>;
// Three registers hold as many whole vectors as one holds floats: the order of x, y and z repeats.
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

// The exponent of a non-finite float is all ones: adding one carries into the sign bit.
HWY_INLINE VBits carry(V value) {
  const Bits d;
  const VBits size = hn::And(hn::BitCast(d, value), hn::Set(d, 0x7FFFFFFFu));
  return hn::Add(size, hn::Set(d, 0x00800000u));
}

HWY_INLINE bool none_carried(VBits carried) {
  const Bits d;
  return hn::AllFalse(d, hn::Ne(hn::And(carried, hn::Set(d, 0x80000000u)), hn::Zero(d)));
}

bool all_finite_wide(const float* numbers, std::size_t count) {
  const Lanes d;
  const Bits bits;
  VBits a = hn::Zero(bits), b = a, c = a;
  for (std::size_t i = 0; i < count; i += 3 * kLanes) {
    const float* from = numbers + i;
    a = hn::Or(a, carry(hn::LoadU(d, from)));
    b = hn::Or(b, carry(hn::LoadU(d, from + kLanes)));
    c = hn::Or(c, carry(hn::LoadU(d, from + 2 * kLanes)));
  }
  return none_carried(hn::Or(a, hn::Or(b, c)));
}

struct Register {
  V least, most;
  VBits carried;
};

HWY_INLINE void subtract(const float* base, float* to, Register& sum) {
  const Lanes d;
  const V moved = hn::Sub(hn::LoadU(d, to), hn::LoadU(d, base));
  hn::StoreU(moved, d, to);
  sum.least = hn::Min(sum.least, moved);
  sum.most = hn::Max(sum.most, moved);
  sum.carried = hn::Or(sum.carried, carry(moved));
}

VectorBounds subtract_wide(const Vec3f* base, Vec3f* vectors, std::size_t count) {
  const Lanes d;
  VectorBounds bounds = no_bounds();
  const Register none = {hn::Set(d, bounds.least.x()), hn::Set(d, bounds.most.x()),
                         hn::Zero(Bits())};
  Register a = none, b = none, c = none;
  for (std::size_t v = 0; v < count; v += kLanes) {
    const float* from = base[v].data();
    float* to = vectors[v].data();
    subtract(from, to, a);
    subtract(from + kLanes, to + kLanes, b);
    subtract(from + 2 * kLanes, to + 2 * kLanes, c);
  }
  HWY_ALIGN float least[3 * kLanes], most[3 * kLanes];
  std::size_t at = 0;
  for (const Register& r : {a, b, c}) {
    hn::Store(r.least, d, least + at);
    hn::Store(r.most, d, most + at);
    at += kLanes;
  }
  for (std::size_t i = 0; i < 3 * kLanes; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    bounds.least[axis] = std::min(bounds.least[axis], least[i]);
    bounds.most[axis] = std::max(bounds.most[axis], most[i]);
  }
  bounds.finite = none_carried(hn::Or(a.carried, hn::Or(b.carried, c.carried)));
  return bounds;
}

std::size_t lanes() {
  return kLanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace krok::vector_arrays_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok {

namespace vector_arrays_detail {

bool all_finite(std::span<const float> numbers) {
  return std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); });
}

void subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors, VectorBounds& bounds) {
  for (std::size_t v = 0; v < vectors.size(); ++v) {
    vectors[v] -= base[v];
    bounds.least = bounds.least.cwiseMin(vectors[v]);
    bounds.most = bounds.most.cwiseMax(vectors[v]);
    bounds.finite = bounds.finite && vectors[v].allFinite();
  }
}

VectorBounds no_bounds() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {Vec3f::Constant(kInfinity), Vec3f::Constant(-kInfinity), true};
}

bool all_finite_best(std::span<const float> numbers) {
  const auto lanes_of_best = KROK_BEST_VERSION(lanes);
  const std::size_t wide = numbers.size() - numbers.size() % (3 * lanes_of_best());
  const auto best = KROK_BEST_VERSION(all_finite_wide);
  return best(numbers.data(), wide) && all_finite(numbers.subspan(wide));
}

VectorBounds subtract_best(std::span<const Vec3f> base, std::span<Vec3f> vectors) {
  const auto lanes_of_best = KROK_BEST_VERSION(lanes);
  const std::size_t wide = vectors.size() - vectors.size() % lanes_of_best();
  const auto best = KROK_BEST_VERSION(subtract_wide);
  VectorBounds bounds = best(base.data(), vectors.data(), wide);
  subtract(base.subspan(wide), vectors.subspan(wide), bounds);
  // Whether 0 or -0 is the min depends on the order; adding 0 makes both 0.
  bounds.least.array() += 0.0f;
  bounds.most.array() += 0.0f;
  return bounds;
}

}  // namespace vector_arrays_detail

bool all_finite(std::span<const Vec3f> vectors) {
  if (vectors.empty()) return true;
  return vector_arrays_detail::all_finite_best({vectors.front().data(), 3 * vectors.size()});
}

bool all_finite(std::span<const Vec4f> vectors) {
  if (vectors.empty()) return true;
  return vector_arrays_detail::all_finite_best({vectors.front().data(), 4 * vectors.size()});
}

VectorBounds subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors) {
  return vector_arrays_detail::subtract_best(base, vectors);
}

}  // namespace krok

#endif  // HWY_ONCE
