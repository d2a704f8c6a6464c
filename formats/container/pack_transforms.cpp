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
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

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
constexpr std::size_t kOrientation = 3 * sizeof(float);  // its offset in a record
constexpr std::size_t kRecord = 6 * sizeof(float);

// Each function mirrors the one of the same name in packed_orientation.cpp, operation by operation
// and without FMA, so that results are bit-identical.

HWY_INLINE V rebuilt_w(V x, V y, V z) {
  const Doubles d;
  const V square =
      hn::Sub(hn::Sub(hn::Sub(hn::Set(d, 1.0), hn::Mul(x, x)), hn::Mul(y, y)), hn::Mul(z, z));
  return hn::IfThenElseZero(hn::Gt(square, hn::Zero(d)), hn::Neg(hn::Sqrt(square)));
}

// Rounds to float; -0 becomes 0.
HWY_INLINE V rounded(V value) {
  const Doubles d;
  return hn::Add(hn::PromoteTo(d, hn::DemoteTo(Floats(), value)), hn::Zero(d));
}

// `value` must be representable as float.
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

// The components by magnitude; ties in index order.
struct BySize {
  V a, b, c;
  V place_a, place_b, place_c;
};

HWY_INLINE BySize by_size(V x, V y, V z) {
  const Doubles d;
  BySize sorted{x, y, z, hn::Zero(d), hn::Set(d, 1.0), hn::Set(d, 2.0)};
  const auto settle = [](V& first, V& second, V& first_place, V& second_place) {
    const auto swap = hn::Lt(hn::Abs(first), hn::Abs(second));
    const V before = first, place_before = first_place;
    first = hn::IfThenElse(swap, second, first);
    second = hn::IfThenElse(swap, before, second);
    first_place = hn::IfThenElse(swap, second_place, first_place);
    second_place = hn::IfThenElse(swap, place_before, second_place);
  };
  settle(sorted.a, sorted.b, sorted.place_a, sorted.place_b);
  settle(sorted.b, sorted.c, sorted.place_b, sorted.place_c);
  settle(sorted.a, sorted.b, sorted.place_a, sorted.place_b);
  return sorted;
}

// What remains for the other components after a step of the largest.
struct AfterA {
  V try_a, left, nearest_b, spacing_b;
};

// Candidate solutions, one per lane.
struct Tries {
  V a, b, c, distance;
};

// Inputs of a search, one target per lane.
struct Search {
  V a, b, c, w;
  V nearest_a, spacing_a, rest_of_a, rest_of_b;

  HWY_INLINE Search(V a_, V b_, V c_, V w_) : a(a_), b(b_), c(c_), w(w_) {
    const V c_squared = hn::Mul(c, c);
    const V w_squared = hn::Mul(w, w);
    nearest_a = rounded(a);
    spacing_a = spacing(nearest_a);
    rest_of_a = hn::Sqrt(hn::Add(hn::Add(hn::Mul(b, b), c_squared), w_squared));
    rest_of_b = hn::Sqrt(hn::Add(c_squared, w_squared));
  }

  HWY_INLINE V distance(V try_a, V try_b, V try_c) const {
    return squared_distance(hn::Sub(try_a, a), hn::Sub(try_b, b), hn::Sub(try_c, c),
                            hn::Sub(rebuilt_w(try_a, try_b, try_c), w));
  }
  HWY_INLINE Tries nearest() const {
    const V nearest_b = rounded(b), nearest_c = rounded(c);
    return {nearest_a, nearest_b, nearest_c, distance(nearest_a, nearest_b, nearest_c)};
  }
  HWY_INLINE AfterA after(V first) const {
    AfterA result;
    result.try_a = rounded(hn::Add(nearest_a, hn::Mul(first, spacing_a)));
    result.left = hn::Sub(hn::Set(Doubles(), 1.0), hn::Mul(result.try_a, result.try_a));
    result.nearest_b = rounded(hn::Mul(b, scale(result.left, rest_of_a)));
    result.spacing_b = spacing(result.nearest_b);
    return result;
  }
  HWY_INLINE Tries solve(const AfterA& at, V second) const {
    Tries result;
    result.a = at.try_a;
    result.b = rounded(hn::Add(at.nearest_b, hn::Mul(second, at.spacing_b)));
    const V left_by_b = hn::Sub(at.left, hn::Mul(result.b, result.b));
    result.c = rounded(hn::Mul(c, scale(left_by_b, rest_of_b)));
    result.distance = distance(result.a, result.b, result.c);
    return result;
  }
};

// Number of steps to try for a target.
HWY_INLINE V steps_worth_trying(V w) {
  const Doubles d;
  const auto steps = [&](int reach) {
    return hn::Set(d, static_cast<double>((2 * reach + 1) * (2 * reach + 1)));
  };
  const V size = hn::Abs(w);
  return hn::IfThenElse(
      hn::Gt(size, hn::Set(d, kOneRing)), steps(1),
      hn::IfThenElse(hn::Gt(size, hn::Set(d, kThreeRings)), steps(3), steps(kReach)));
}

// Most targets need only the first step, few more than one ring. Those that need more are queued
// until all lanes are filled.
constexpr std::array<std::size_t, 3> kStages = {1, 9, kSteps.size()};
static_assert(kSteps[0].first == 0 && kSteps[0].second == 0);

// Unit quaternions with w <= 0 to search for, one per lane.
struct Targets {
  HWY_ALIGN double x[kLanes], y[kLanes], z[kLanes], w[kLanes];
  std::byte* out[kLanes];
  std::size_t records[kLanes];  // consecutive records that get the result
  std::size_t count = 0;

  HWY_INLINE void add(const Targets& from, std::size_t i) {
    x[count] = from.x[i];
    y[count] = from.y[i];
    z[count] = from.z[i];
    w[count] = from.w[i];
    out[count] = from.out[i];
    records[count] = from.records[i];
    ++count;
  }
};

class Searches {
 public:
  // Adds the target in lane `lane` of x, y, z and w.
  HWY_INLINE void add(const double* const xyzw[4], std::size_t lane, std::byte* out) {
    Targets& targets = stages_[0];
    if (targets.count == kLanes) search(0);
    targets.x[targets.count] = xyzw[0][lane];
    targets.y[targets.count] = xyzw[1][lane];
    targets.z[targets.count] = xyzw[2][lane];
    targets.w[targets.count] = xyzw[3][lane];
    targets.out[targets.count] = out;
    targets.records[targets.count] = 1;
    ++targets.count;
  }
  // The record after the last one added, or repeated, has the same target.
  HWY_INLINE void repeat() { ++stages_[0].records[stages_[0].count - 1]; }

  void finish() {
    for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
      if (stages_[stage].count > 0) search(stage);
    }
  }

 private:
  void search(std::size_t stage);

  std::array<Targets, kStages.size()> stages_;
};

void Searches::search(std::size_t stage) {
  const Doubles d;
  Targets& targets = stages_[stage];
  // Unused lanes repeat the first one; their results are discarded.
  for (std::size_t i = targets.count; i < kLanes; ++i) {
    targets.x[i] = targets.x[0];
    targets.y[i] = targets.y[0];
    targets.z[i] = targets.z[0];
    targets.w[i] = targets.w[0];
  }
  const BySize sorted =
      by_size(hn::Load(d, targets.x), hn::Load(d, targets.y), hn::Load(d, targets.z));
  const Search search(sorted.a, sorted.b, sorted.c, hn::Load(d, targets.w));
  const V good = hn::Set(d, kGoodEnough);
  const V worth_trying = steps_worth_trying(search.w);
  std::array<AfterA, kSide> after;
  std::array<bool, kSide> known{};

  Tries best = search.nearest();
  auto open = hn::Gt(best.distance, good);
  for (std::size_t s = 0; s < kStages[stage] && !hn::AllFalse(d, open); ++s) {
    const auto first = static_cast<std::size_t>(kSteps[s].first + kReach);
    if (!known[first]) after[first] = search.after(hn::Set(d, kSteps[s].first));
    known[first] = true;
    const Tries tries = search.solve(after[first], hn::Set(d, kSteps[s].second));
    const auto better = hn::And(open, hn::Lt(tries.distance, best.distance));
    best.a = hn::IfThenElse(better, tries.a, best.a);
    best.b = hn::IfThenElse(better, tries.b, best.b);
    best.c = hn::IfThenElse(better, tries.c, best.c);
    best.distance = hn::IfThenElse(better, tries.distance, best.distance);
    open = hn::And(hn::Gt(best.distance, good),
                   hn::Gt(worth_trying, hn::Set(d, static_cast<double>(s + 1))));
  }

  HWY_ALIGN double values[3][kLanes], places[3][kLanes];
  hn::Store(best.a, d, values[0]);
  hn::Store(best.b, d, values[1]);
  hn::Store(best.c, d, values[2]);
  hn::Store(sorted.place_a, d, places[0]);
  hn::Store(sorted.place_b, d, places[1]);
  hn::Store(sorted.place_c, d, places[2]);
  std::uint8_t open_bits[8] = {};
  hn::StoreMaskBits(d, open, open_bits);
  for (std::size_t i = 0; i < targets.count; ++i) {
    if ((open_bits[0] >> i & 1) != 0) {
      if (stages_[stage + 1].count == kLanes) this->search(stage + 1);
      stages_[stage + 1].add(targets, i);
      continue;
    }
    float packed[3];
    for (int k = 0; k < 3; ++k) {
      packed[static_cast<std::size_t>(places[k][i])] = static_cast<float>(values[k][i]);
    }
    for (std::size_t r = 0; r < targets.records[i]; ++r) {
      std::memcpy(targets.out[i] + r * kRecord, packed, sizeof packed);
    }
  }
  targets.count = 0;
}

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
