#include "formats/container/sections.h"

// Widths below that of AVX2 gain nothing; such a machine takes the scalar functions.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/container/pack_transforms.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/simd.h"
#include "formats/container/orientation_search_internal.h"
#include "formats/container/pack_transforms_internal.h"

HWY_BEFORE_NAMESPACE();
namespace krok::pack_transforms_detail {
namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

namespace hn = hwy::HWY_NAMESPACE;
using namespace orientation_search;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Bits = hn::Rebind<std::uint32_t, Doubles>;
using V = hn::Vec<Doubles>;
constexpr std::size_t kLanes = hn::MaxLanes(Doubles());
static_assert(kLanes <= 8, "a mask fits a byte");
constexpr std::size_t kOrientation = 3 * sizeof(float);  // its place in a record
constexpr std::size_t kRecord = 6 * sizeof(float);

// Each function below does what the one of the same name in packed_orientation.cpp does, operation
// by operation and without fused arithmetic, so that both give the same bits.

HWY_INLINE V rebuilt_w(V x, V y, V z) {
  const Doubles d;
  const V square =
      hn::Sub(hn::Sub(hn::Sub(hn::Set(d, 1.0), hn::Mul(x, x)), hn::Mul(y, y)), hn::Mul(z, z));
  return hn::IfThenElseZero(hn::Gt(square, hn::Zero(d)), hn::Neg(hn::Sqrt(square)));
}

// To the nearest float, as a double, without -0.
HWY_INLINE V rounded(V value) {
  const Doubles d;
  return hn::Add(hn::PromoteTo(d, hn::DemoteTo(Floats(), value)), hn::Zero(d));
}

// `value` has floats.
HWY_INLINE V spacing(V value) {
  const Doubles d;
  const auto size = hn::Abs(hn::DemoteTo(Floats(), value));
  const auto next = hn::BitCast(Floats(), hn::Add(hn::BitCast(Bits(), size), hn::Set(Bits(), 1)));
  return hn::Sub(hn::PromoteTo(d, next), hn::PromoteTo(d, size));
}

HWY_INLINE V scale(V square_left, V rest) {
  const Doubles d;
  const auto usable = hn::And(hn::Gt(square_left, hn::Zero(d)), hn::Gt(rest, hn::Zero(d)));
  return hn::IfThenElseZero(usable, hn::Div(hn::Sqrt(square_left), rest));
}

HWY_INLINE V squared_distance(V dx, V dy, V dz, V dw) {
  return hn::Add(hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz)),
                 hn::Mul(dw, dw));
}

// Exchanges two components with their places where the first is smaller in size.
HWY_INLINE void settle(V& a, V& b, V& place_a, V& place_b) {
  const auto swap = hn::Lt(hn::Abs(a), hn::Abs(b));
  const V before = a, place_before = place_a;
  a = hn::IfThenElse(swap, b, a);
  b = hn::IfThenElse(swap, before, b);
  place_a = hn::IfThenElse(swap, place_b, place_a);
  place_b = hn::IfThenElse(swap, place_before, place_b);
}

// Unit quaternions that are left to the search, a lane each.
struct Targets {
  HWY_ALIGN double x[kLanes], y[kLanes], z[kLanes], w[kLanes];
  std::byte* out[kLanes];
  std::size_t count = 0;
};

void search(Targets& targets) {
  const Doubles d;
  // Lanes that are not used take the first one's work and throw it away.
  for (std::size_t i = targets.count; i < kLanes; ++i) {
    targets.x[i] = targets.x[0];
    targets.y[i] = targets.y[0];
    targets.z[i] = targets.z[0];
    targets.w[i] = targets.w[0];
  }
  V a = hn::Load(d, targets.x), b = hn::Load(d, targets.y), c = hn::Load(d, targets.z);
  const V w = hn::Load(d, targets.w);
  V place_a = hn::Zero(d), place_b = hn::Set(d, 1.0), place_c = hn::Set(d, 2.0);
  settle(a, b, place_a, place_b);
  settle(b, c, place_b, place_c);
  settle(a, b, place_a, place_b);
  const V nearest_a = rounded(a);
  const V spacing_a = spacing(nearest_a);
  const V rest_of_b_squared = hn::Mul(c, c);
  const V w_squared = hn::Mul(w, w);
  const V rest_of_a = hn::Sqrt(hn::Add(hn::Add(hn::Mul(b, b), rest_of_b_squared), w_squared));
  const V rest_of_b = hn::Sqrt(hn::Add(rest_of_b_squared, w_squared));
  const V size = hn::Abs(w);
  const auto steps_for = [&](int reach) {
    return hn::Set(d, static_cast<double>((2 * reach + 1) * (2 * reach + 1)));
  };
  const V steps = hn::IfThenElse(
      hn::Gt(size, hn::Set(d, kOneRing)), steps_for(1),
      hn::IfThenElse(hn::Gt(size, hn::Set(d, kThreeRings)), steps_for(3), steps_for(kReach)));

  V best_a = nearest_a, best_b = rounded(b), best_c = rounded(c);
  V best = squared_distance(hn::Sub(best_a, a), hn::Sub(best_b, b), hn::Sub(best_c, c),
                            hn::Sub(rebuilt_w(best_a, best_b, best_c), w));
  struct AfterA {
    V try_a, nearest_b, left, spacing_b;
  };
  AfterA after_a[kSide];
  bool known[kSide] = {};
  const V good_enough = hn::Set(d, kGoodEnough);
  for (std::size_t s = 0; s < kSteps.size(); ++s) {
    const auto active =
        hn::And(hn::Gt(best, good_enough), hn::Gt(steps, hn::Set(d, static_cast<double>(s))));
    if (hn::AllFalse(d, active)) break;
    const std::size_t first = static_cast<std::size_t>(kSteps[s].first + kReach);
    AfterA& at = after_a[first];
    if (!known[first]) {
      at.try_a = rounded(
          hn::Add(nearest_a, hn::Mul(hn::Set(d, static_cast<double>(kSteps[s].first)), spacing_a)));
      at.left = hn::Sub(hn::Set(d, 1.0), hn::Mul(at.try_a, at.try_a));
      at.nearest_b = rounded(hn::Mul(b, scale(at.left, rest_of_a)));
      at.spacing_b = spacing(at.nearest_b);
      known[first] = true;
    }
    const V second = hn::Set(d, static_cast<double>(kSteps[s].second));
    const V try_b = rounded(hn::Add(at.nearest_b, hn::Mul(second, at.spacing_b)));
    const V left_by_b = hn::Sub(at.left, hn::Mul(try_b, try_b));
    const V try_c = rounded(hn::Mul(c, scale(left_by_b, rest_of_b)));
    const V distance = squared_distance(hn::Sub(at.try_a, a), hn::Sub(try_b, b), hn::Sub(try_c, c),
                                        hn::Sub(rebuilt_w(at.try_a, try_b, try_c), w));
    const auto better = hn::And(active, hn::Lt(distance, best));
    best = hn::IfThenElse(better, distance, best);
    best_a = hn::IfThenElse(better, at.try_a, best_a);
    best_b = hn::IfThenElse(better, try_b, best_b);
    best_c = hn::IfThenElse(better, try_c, best_c);
  }
  HWY_ALIGN double values[3][kLanes], places[3][kLanes];
  hn::Store(best_a, d, values[0]);
  hn::Store(best_b, d, values[1]);
  hn::Store(best_c, d, values[2]);
  hn::Store(place_a, d, places[0]);
  hn::Store(place_b, d, places[1]);
  hn::Store(place_c, d, places[2]);
  for (std::size_t i = 0; i < targets.count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto value = static_cast<float>(values[k][i]);
      std::memcpy(targets.out[i] + sizeof(float) * static_cast<std::size_t>(places[k][i]), &value,
                  sizeof value);
    }
  }
  targets.count = 0;
}

// A group of kLanes transforms, of which the first `used` are stored at `out`. Orientations that
// need the search are added to `few` or `many`, by how many steps it takes, and stored later.
HWY_INLINE void pack_group(const float* positions, const float* orientations, std::size_t used,
                           std::byte* out, Targets& few, Targets& many) {
  const Doubles d;
  const Floats f;
  hn::Vec<Floats> fx, fy, fz, fw;
  hn::LoadInterleaved4(f, orientations, fx, fy, fz, fw);
  V x = hn::PromoteTo(d, fx), y = hn::PromoteTo(d, fy), z = hn::PromoteTo(d, fz),
    w = hn::PromoteTo(d, fw);
  const V zero = hn::Zero(d);
  const V sign = hn::IfThenElseZero(hn::Gt(w, zero), hn::Set(d, -0.0));
  x = hn::Xor(x, sign);
  y = hn::Xor(y, sign);
  z = hn::Xor(z, sign);
  w = hn::Xor(w, sign);
  const auto as_it_is = hn::Eq(hn::PromoteTo(d, hn::DemoteTo(f, rebuilt_w(x, y, z))), w);

  const V length = hn::Sqrt(
      hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Add(hn::Mul(z, z), hn::Mul(w, w))));
  const auto regular = hn::And(hn::Gt(length, zero),
                               hn::Lt(length, hn::Set(d, std::numeric_limits<double>::infinity())));
  const V tx = hn::Div(x, length), ty = hn::Div(y, length), tz = hn::Div(z, length),
          tw = hn::Div(w, length);
  const V nx = rounded(tx), ny = rounded(ty), nz = rounded(tz);
  const V distance = squared_distance(hn::Sub(nx, tx), hn::Sub(ny, ty), hn::Sub(nz, tz),
                                      hn::Sub(rebuilt_w(nx, ny, nz), tw));
  const auto near_enough = hn::And(regular, hn::Le(distance, hn::Set(d, kGoodEnough)));
  const auto done = hn::Or(as_it_is, near_enough);

  HWY_ALIGN float packed[4 * kLanes];
  const auto chosen = [&](V plain, V nearest) {
    const V value = hn::IfThenElse(as_it_is, hn::Add(plain, zero), nearest);
    return hn::DemoteTo(f, hn::IfThenElseZero(hn::Or(as_it_is, regular), value));
  };
  hn::StoreInterleaved3(chosen(x, nx), chosen(y, ny), chosen(z, nz), f, packed);
  for (std::size_t i = 0; i < used; ++i) {
    std::memcpy(out + i * kRecord, positions + 3 * i, 3 * sizeof(float));
    std::memcpy(out + i * kRecord + kOrientation, packed + 3 * i, 3 * sizeof(float));
  }
  const auto searched = hn::AndNot(done, regular);
  if (HWY_LIKELY(hn::AllFalse(d, searched))) return;

  HWY_ALIGN double target[4][kLanes];
  hn::Store(tx, d, target[0]);
  hn::Store(ty, d, target[1]);
  hn::Store(tz, d, target[2]);
  hn::Store(tw, d, target[3]);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, searched, bits);
  for (unsigned left = bits[0]; left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
    Targets& targets = target[3][i] < -kOneRing ? few : many;
    targets.x[targets.count] = target[0][i];
    targets.y[targets.count] = target[1][i];
    targets.z[targets.count] = target[2][i];
    targets.w[targets.count] = target[3][i];
    targets.out[targets.count] = out + i * kRecord + kOrientation;
    if (++targets.count == kLanes) search(targets);
  }
}

void pack(const float* positions, const float* orientations, std::size_t count, std::byte* out) {
  Targets few, many;
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    pack_group(positions + 3 * i, orientations + 4 * i, kLanes, out + i * kRecord, few, many);
  }
  if (i < count) {
    // Filled up with identities, which need no search.
    HWY_ALIGN float tail[4 * kLanes] = {};
    for (std::size_t k = 0; k < kLanes; ++k) tail[4 * k + 3] = 1;
    std::copy_n(orientations + 4 * i, 4 * (count - i), tail);
    pack_group(positions + 3 * i, tail, count - i, out + i * kRecord, few, many);
  }
  if (few.count > 0) search(few);
  if (many.count > 0) search(many);
}

#else

void pack(const float* positions, const float* orientations, std::size_t count, std::byte* out) {
  pack_scalar(positions, orientations, count, out);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::pack_transforms_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok {

namespace pack_transforms_detail {
namespace {

using Pack = void(const float*, const float*, std::size_t, std::byte*);

Pack* best_pack() {
  return KROK_BEST_VERSION(pack);
}

}  // namespace
}  // namespace pack_transforms_detail

void write_transforms(std::span<const Vec3f> positions, std::span<const Quatf> orientations,
                      OrientationEncoding encoding, std::byte* out) {
  assert(positions.size() == orientations.size());
  if (positions.empty()) return;
  if (encoding == OrientationEncoding::xyz) {
    const auto best = pack_transforms_detail::best_pack();
    best(positions[0].data(), orientations[0].coeffs().data(), positions.size(), out);
    return;
  }
  constexpr std::size_t kPosition = sizeof(Vec3f), kOrientation = sizeof(Quatf);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::byte* record = out + i * (kPosition + kOrientation);
    std::memcpy(record, positions[i].data(), kPosition);
    std::memcpy(record + kPosition, orientations[i].coeffs().data(), kOrientation);
  }
}

}  // namespace krok

#endif  // HWY_ONCE
