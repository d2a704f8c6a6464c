#include "pose/pose_kernels_internal.h"

// The results require FMA, so targets without it are left out: such a machine uses the static
// target below, which is the scalar reference. Only targets that KROK_BEST_VERSION can choose are
// compiled.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose/pose_kernels.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::pose_detail {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, PoseBlock::kLanes>;
using V = hn::Vec<Lanes>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

struct Position {
  V x, y, z;
};
struct Rotation {
  V x, y, z, w;
};

HWY_INLINE V number(float value) {
  return hn::Set(Lanes(), value);
}

HWY_INLINE Position position_of(const PoseBlock& block, std::size_t lane) {
  const Lanes d;
  return {hn::Load(d, block.position[0] + lane), hn::Load(d, block.position[1] + lane),
          hn::Load(d, block.position[2] + lane)};
}
HWY_INLINE Rotation rotation_of(const PoseBlock& block, std::size_t lane) {
  const Lanes d;
  return {hn::Load(d, block.rotation[0] + lane), hn::Load(d, block.rotation[1] + lane),
          hn::Load(d, block.rotation[2] + lane), hn::Load(d, block.rotation[3] + lane)};
}
HWY_INLINE void store(const Position& p, const Rotation& q, PoseBlock& block, std::size_t lane) {
  const Lanes d;
  hn::Store(p.x, d, block.position[0] + lane);
  hn::Store(p.y, d, block.position[1] + lane);
  hn::Store(p.z, d, block.position[2] + lane);
  hn::Store(q.x, d, block.rotation[0] + lane);
  hn::Store(q.y, d, block.rotation[1] + lane);
  hn::Store(q.z, d, block.rotation[2] + lane);
  hn::Store(q.w, d, block.rotation[3] + lane);
}

HWY_INLINE V dot(const Rotation& a, const Rotation& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::MulAdd(a.z, b.z, hn::Mul(a.w, b.w))));
}

HWY_INLINE Position sum_of(V factor, const Position& p, const Position& sum) {
  return {hn::MulAdd(factor, p.x, sum.x), hn::MulAdd(factor, p.y, sum.y),
          hn::MulAdd(factor, p.z, sum.z)};
}
HWY_INLINE Rotation sum_of(V factor, const Rotation& q, const Rotation& sum) {
  return {hn::MulAdd(factor, q.x, sum.x), hn::MulAdd(factor, q.y, sum.y),
          hn::MulAdd(factor, q.z, sum.z), hn::MulAdd(factor, q.w, sum.w)};
}
HWY_INLINE Position scaled(V factor, const Position& p) {
  return {hn::Mul(factor, p.x), hn::Mul(factor, p.y), hn::Mul(factor, p.z)};
}
HWY_INLINE Rotation scaled(V factor, const Rotation& q) {
  return {hn::Mul(factor, q.x), hn::Mul(factor, q.y), hn::Mul(factor, q.z), hn::Mul(factor, q.w)};
}

// `factor`, negated if q is not in the hemisphere of `towards`.
HWY_INLINE V signed_factor(V factor, const Rotation& q, const Rotation& towards) {
  const auto away = hn::Lt(dot(q, towards), hn::Zero(Lanes()));
  return hn::IfThenElse(away, hn::Neg(factor), factor);
}

HWY_INLINE V inverse_length(V square) {
  return hn::Div(number(1.0f), hn::Sqrt(square));
}

void sample(const Between& term, std::size_t blocks, PoseBlock* pose) {
  const V after = number(term.part);
  const V before = number(1.0f - term.part);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t lane = 0; lane < PoseBlock::kLanes; lane += kLanes) {
      const Position p = sum_of(after, position_of(term.after[b], lane),
                                scaled(before, position_of(term.before[b], lane)));
      const Rotation q = sum_of(after, rotation_of(term.after[b], lane),
                                scaled(before, rotation_of(term.before[b], lane)));
      store(p, scaled(inverse_length(dot(q, q)), q), pose[b], lane);
    }
  }
}

// The sum of the terms for kLanes joints of block b.
HWY_INLINE void add_terms(const Between* HWY_RESTRICT terms, std::size_t count,
                          const Rotation& towards, std::size_t b, std::size_t lane,
                          Position& position, Rotation& rotation) {
  for (std::size_t t = 0; t < count; ++t) {
    const PoseBlock& before = terms[t].before[b];
    const PoseBlock& after = terms[t].after[b];
    const float part = terms[t].part;
    const float rest = 1.0f - part;
    const float weight = terms[t].weight;
    position = sum_of(number(weight * part), position_of(after, lane),
                      sum_of(number(weight * rest), position_of(before, lane), position));
    const Rotation q = sum_of(number(part), rotation_of(after, lane),
                              scaled(number(rest), rotation_of(before, lane)));
    const V factor = hn::Div(number(weight), hn::Sqrt(dot(q, q)));
    rotation = sum_of(signed_factor(factor, q, towards), q, rotation);
  }
}

float blend(const Between* terms, std::size_t count, Round round, const PoseBlock* reference,
            std::size_t blocks, PoseBlock* sum) {
  const Lanes d;
  const V zero = hn::Zero(d);
  V least = number(hwy::HighestValue<float>());
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t lane = 0; lane < PoseBlock::kLanes; lane += kLanes) {
      Position position = {zero, zero, zero};
      Rotation rotation = {zero, zero, zero, zero};
      if (!round.first) {
        position = position_of(sum[b], lane);
        rotation = rotation_of(sum[b], lane);
      }
      const Rotation towards = rotation_of(reference[b], lane);
      add_terms(terms, count, towards, b, lane, position, rotation);
      if (round.last) {
        const V square = dot(rotation, rotation);
        const auto regular = hn::Gt(square, number(kMinSquare));
        least = hn::Min(least, hn::IfThenElseZero(regular, square));
        const Rotation unit = scaled(inverse_length(square), rotation);
        rotation = {
            hn::IfThenElse(regular, unit.x, towards.x), hn::IfThenElse(regular, unit.y, towards.y),
            hn::IfThenElse(regular, unit.z, towards.z), hn::IfThenElse(regular, unit.w, towards.w)};
      }
      store(position, rotation, sum[b], lane);
    }
  }
  return round.last && blocks != 0 ? hn::GetLane(hn::MinOfLanes(d, least)) : 1.0f;
}

void add(const PoseBlock* pose, float weight, const PoseBlock* reference, std::size_t blocks,
         PoseBlock* sum) {
  const V own = number(weight);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t lane = 0; lane < PoseBlock::kLanes; lane += kLanes) {
      const Rotation q = rotation_of(pose[b], lane);
      const V factor = signed_factor(own, q, rotation_of(reference[b], lane));
      store(sum_of(own, position_of(pose[b], lane), position_of(sum[b], lane)),
            sum_of(factor, q, rotation_of(sum[b], lane)), sum[b], lane);
    }
  }
}

Kernels kernels() {
  return {sample, blend, add};
}

#else

Kernels kernels() {
  return scalar_kernels();
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::pose_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::pose_detail {

Kernels best_kernels() {
  return KROK_BEST_VERSION(kernels)();
}

}  // namespace krok::pose_detail

#endif  // HWY_ONCE
