#include "formats/gltf/track_kernel_internal.h"

// Vector widths below AVX2 gain little; such CPUs use Highway's baseline target.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/gltf/track_kernel.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets macros that highway.h reads.
#include <hwy/highway.h>

#include <cstring>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::gltf::track_detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 16>;
using Floats = hn::Rebind<float, Doubles>;
using V = hn::Vec<Doubles>;
constexpr std::size_t kLanes = hn::MaxLanes(Doubles());
static_assert(7 * kLanes <= kScratch);

// No FMA, and the same order of operations for every vector width: results are bit-identical on all
// CPUs.

struct Vector {
  V x, y, z;
};
struct Rotation {
  V x, y, z, w;
};
struct Frame {
  Vector position;
  Rotation rotation;
};

HWY_INLINE V number(double value) {
  return hn::Set(Doubles(), value);
}

HWY_INLINE V squared(const Vector& v) {
  return hn::Add(hn::Add(hn::Mul(v.x, v.x), hn::Mul(v.y, v.y)), hn::Mul(v.z, v.z));
}

HWY_INLINE Rotation normalized(const Rotation& q) {
  const V square = hn::Add(hn::Add(hn::Mul(q.x, q.x), hn::Mul(q.y, q.y)),
                           hn::Add(hn::Mul(q.z, q.z), hn::Mul(q.w, q.w)));
  const V scale = hn::Div(number(1.0), hn::Sqrt(square));
  return {hn::Mul(q.x, scale), hn::Mul(q.y, scale), hn::Mul(q.z, scale), hn::Mul(q.w, scale)};
}

HWY_INLINE Rotation conjugate(const Rotation& q) {
  return {hn::Neg(q.x), hn::Neg(q.y), hn::Neg(q.z), q.w};
}

HWY_INLINE Rotation product(const Rotation& a, const Rotation& b) {
  const auto four = [](V p, V q, V r, V s) { return hn::Sub(hn::Add(hn::Add(p, q), r), s); };
  return {four(hn::Mul(a.w, b.x), hn::Mul(a.x, b.w), hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          four(hn::Mul(a.w, b.y), hn::Mul(a.y, b.w), hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          four(hn::Mul(a.w, b.z), hn::Mul(a.z, b.w), hn::Mul(a.x, b.y), hn::Mul(a.y, b.x)),
          hn::Sub(hn::Sub(hn::Sub(hn::Mul(a.w, b.w), hn::Mul(a.x, b.x)), hn::Mul(a.y, b.y)),
                  hn::Mul(a.z, b.z))};
}

HWY_INLINE Vector cross(const Rotation& q, const Vector& v) {
  return {hn::Sub(hn::Mul(q.y, v.z), hn::Mul(q.z, v.y)),
          hn::Sub(hn::Mul(q.z, v.x), hn::Mul(q.x, v.z)),
          hn::Sub(hn::Mul(q.x, v.y), hn::Mul(q.y, v.x))};
}

HWY_INLINE Vector sum(const Vector& a, const Vector& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE Vector difference(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE Vector turned(const Rotation& q, const Vector& v) {
  const Vector half = cross(q, v);
  const Vector u = sum(half, half);
  const Vector scaled = {hn::Mul(q.w, u.x), hn::Mul(q.w, u.y), hn::Mul(q.w, u.z)};
  return sum(sum(v, scaled), cross(q, u));
}

// Rounds to float.
HWY_INLINE V as_float(V value) {
  return hn::PromoteTo(Doubles(), hn::DemoteTo(Floats(), value));
}

HWY_INLINE Rotation rotation_of(const float* q) {
  return {number(q[0]), number(q[1]), number(q[2]), number(q[3])};
}

// Loads one joint in kLanes frames, `stride` joints apart; lanes beyond `used` repeat the last one.
HWY_INLINE Frame gather(const float* positions, const float* orientations, std::size_t stride,
                        std::size_t used) {
  HWY_ALIGN float parts[7][kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t at = (i < used ? i : used - 1) * stride;
    for (std::size_t k = 0; k < 3; ++k) parts[k][i] = positions[3 * at + k];
    for (std::size_t k = 0; k < 4; ++k) parts[3 + k][i] = orientations[4 * at + k];
  }
  const auto part = [&](std::size_t k) {
    return hn::PromoteTo(Doubles(), hn::Load(Floats(), parts[k]));
  };
  return {{part(0), part(1), part(2)}, {part(3), part(4), part(5), part(6)}};
}

HWY_INLINE Frame load(const double* at) {
  const Doubles d;
  const auto part = [&](std::size_t k) { return hn::Load(d, at + k * kLanes); };
  return {{part(0), part(1), part(2)}, {part(3), part(4), part(5), part(6)}};
}

HWY_INLINE void store(const Frame& frame, double* at) {
  const Doubles d;
  const V parts[7] = {frame.position.x, frame.position.y, frame.position.z, frame.rotation.x,
                      frame.rotation.y, frame.rotation.z, frame.rotation.w};
  for (std::size_t k = 0; k < 7; ++k) hn::Store(parts[k], d, at + k * kLanes);
}

HWY_INLINE void put_rotations(const Rotation& q, std::size_t used, float* to) {
  const Floats f;
  HWY_ALIGN float values[4 * kLanes];
  hn::StoreInterleaved4(hn::DemoteTo(f, q.x), hn::DemoteTo(f, q.y), hn::DemoteTo(f, q.z),
                        hn::DemoteTo(f, q.w), f, values);
  std::memcpy(to, values, used * 4 * sizeof(float));
}

HWY_INLINE void put_translations(const Vector& v, std::size_t used, float* to) {
  const Floats f;
  HWY_ALIGN float values[4 * kLanes];
  hn::StoreInterleaved3(hn::DemoteTo(f, v.x), hn::DemoteTo(f, v.y), hn::DemoteTo(f, v.z), f,
                        values);
  std::memcpy(to, values, used * 3 * sizeof(float));
}

// Whether any angle between two rotations exceeds `tolerance`, which is small: the vector part of
// their quotient is the sine of half the angle, w the cosine.
HWY_INLINE bool differ(const Rotation& a, const Rotation& b, double tolerance) {
  const Doubles d;
  const Rotation q = product(conjugate(a), b);
  const V limit = hn::Mul(hn::Mul(q.w, q.w), number(0.25 * tolerance * tolerance));
  return !hn::AllFalse(d, hn::Gt(squared({q.x, q.y, q.z}), limit));
}

void joint_tracks(const Nodes& nodes, const float* positions, const float* orientations,
                  std::size_t frames, const Places* places, double* scratch, std::uint8_t* seen) {
  const Doubles d;
  for (std::size_t f = 0; f < frames; f += kLanes) {
    const std::size_t used = frames - f < kLanes ? frames - f : kLanes;
    for (std::size_t j = 0; j < nodes.joints; ++j) {
      const std::size_t place = f * nodes.joints + j;
      const Frame world =
          gather(positions + 3 * place, orientations + 4 * place, nodes.joints, used);
      const bool is_root = nodes.parents[j] < 0;
      const Frame parent =
          is_root ? Frame{{number(0), number(0), number(0)},
                          {number(0), number(0), number(0), number(1)}}
                  : load(scratch + static_cast<std::size_t>(nodes.parents[j]) * 7 * kLanes);
      const Rotation to_parent = conjugate(parent.rotation);
      const Rotation rest = rotation_of(nodes.rest_rotations + 4 * j);
      const float* t = nodes.rest_translations + 3 * j;
      const Vector rest_translation = {number(t[0]), number(t[1]), number(t[2])};

      const Rotation local = normalized(product(to_parent, normalized(world.rotation)));
      const Vector moved = turned(to_parent, difference(world.position, parent.position));
      const Vector kept = sum(turned(parent.rotation, rest_translation), parent.position);
      const V off = squared(difference(kept, world.position));
      const V limit = number(nodes.position_tolerance * nodes.position_tolerance);
      if (differ(normalized(rest), local, nodes.angle_tolerance)) seen[j] |= kRotates;
      if (!hn::AllFalse(d, hn::Gt(off, limit))) seen[j] |= kMoves;

      // What a viewer computes from the floats.
      Frame shown = {rest_translation, normalized(rest)};
      if ((nodes.tracks[j] & kRotates) != 0) {
        shown.rotation = normalized(
            {as_float(local.x), as_float(local.y), as_float(local.z), as_float(local.w)});
        if (places[j].rotations != nullptr) {
          put_rotations(local, used, places[j].rotations + 4 * f);
        }
      }
      if ((nodes.tracks[j] & kMoves) != 0) {
        shown.position = {as_float(moved.x), as_float(moved.y), as_float(moved.z)};
        if (places[j].translations != nullptr) {
          put_translations(moved, used, places[j].translations + 3 * f);
        }
      }
      if (!is_root) {
        shown = {sum(turned(parent.rotation, shown.position), parent.position),
                 product(parent.rotation, shown.rotation)};
      }
      store(shown, scratch + j * 7 * kLanes);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace krok::gltf::track_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::gltf::track_detail {

void joint_tracks(const Nodes& nodes, const float* positions, const float* orientations,
                  std::size_t frames, const Places* places, double* scratch, std::uint8_t* seen) {
  const auto best = KROK_BEST_VERSION(joint_tracks);
  best(nodes, positions, orientations, frames, places, scratch, seen);
}

}  // namespace krok::gltf::track_detail

#endif  // HWY_ONCE
