#include "formats/container/sections.h"

// Vector widths below AVX2 gain nothing; such CPUs use the scalar functions.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/container/pack_transforms.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets macros that highway.h reads.
#include <hwy/highway.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/simd.h"
#include "formats/container/orientation_search_internal.h"
// Needs highway.h and the headers above.
#include "formats/container/orientation_search_lanes.inc"

HWY_BEFORE_NAMESPACE();
namespace krok::pack_transforms_detail {
namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

// Bit mask of the orientations that equal the previous record's.
HWY_INLINE unsigned repeated_bits(const float* orientations) {
  const Floats f;
  hn::Vec<Floats> x, y, z, w, x_before, y_before, z_before, w_before;
  hn::LoadInterleaved4(f, orientations, x, y, z, w);
  hn::LoadInterleaved4(f, orientations - 4, x_before, y_before, z_before, w_before);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(f,
                    hn::And(hn::And(hn::Eq(x, x_before), hn::Eq(y, y_before)),
                            hn::And(hn::Eq(z, z_before), hn::Eq(w, w_before))),
                    bits);
  return bits[0];
}

// Packs kLanes transforms and stores the first `used` at `out`. Orientations that need the search
// are added to `searches` and stored later. `follows`: inputs and output have a previous record.
HWY_INLINE void pack_group(const float* positions, const float* orientations, std::size_t used,
                           bool follows, std::byte* out, Searches& searches) {
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
  // End sites have the orientation of their parent joint.
  const unsigned repeated = follows ? repeated_bits(orientations) : 0;
  const double* const xyzw[4] = {target[0], target[1], target[2], target[3]};
  for (unsigned left = bits[0]; left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
    if ((repeated >> i & 1) != 0) {
      searches.repeat();
    } else {
      searches.add(xyzw, i, out + i * kRecord + kOrientation);
    }
  }
}

void pack(const float* positions, const float* orientations, std::size_t count, std::byte* out) {
  Searches searches;
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    pack_group(positions + 3 * i, orientations + 4 * i, kLanes, i > 0, out + i * kRecord, searches);
  }
  if (i < count) {
    // Padded with identities, which need no search.
    HWY_ALIGN float tail[4 * kLanes] = {};
    for (std::size_t k = 0; k < kLanes; ++k) tail[4 * k + 3] = 1;
    std::copy_n(orientations + 4 * i, 4 * (count - i), tail);
    pack_group(positions + 3 * i, tail, count - i, false, out + i * kRecord, searches);
  }
  searches.finish();
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
