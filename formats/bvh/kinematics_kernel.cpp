#include "formats/bvh/kinematics_kernel.h"

// Vectors narrower than AVX2 gain little; such CPUs use the scalar reference.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/bvh/kinematics_kernel.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets macros that highway.h uses.
#include <hwy/highway.h>

#include <cstring>

#include "core/simd.h"
#include "formats/bvh/half_angle.h"

HWY_BEFORE_NAMESPACE();
namespace krok::bvh::kinematics_detail {
namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

namespace hn = hwy::HWY_NAMESPACE;
using namespace half_angle_detail;

using Doubles = hn::CappedTag<double, kFramesAtOnce>;
using Integers = hn::RebindToUnsigned<Doubles>;
using Floats = hn::Rebind<float, Doubles>;
using V = hn::Vec<Doubles>;
constexpr std::size_t kLanes = hn::MaxLanes(Doubles());

// Performs the same operations as the scalar reference, in the same order and without FMA, so that
// results are bit-identical.

// Sets `near` to false if an angle is out of range.
HWY_INLINE V near_enough(V degrees, bool& near) {
  const Doubles d;
  const auto far = hn::Gt(hn::Abs(degrees), hn::Set(d, kFarthestAngle));
  if (HWY_LIKELY(hn::AllFalse(d, far))) return degrees;
  near = false;
  HWY_ALIGN double values[kLanes];
  hn::Store(degrees, d, values);
  for (double& value : values) value = near_angle(value);
  return hn::IfThenElse(far, hn::Load(d, values), degrees);
}

HWY_INLINE void half_angles(V degrees, V& sine, V& cosine, bool& near) {
  const Doubles d;
  const Integers u;
  degrees = near_enough(degrees, near);
  const V rounder = hn::Set(d, kRounder);
  const V rounding = hn::Add(hn::Mul(degrees, hn::Set(d, kHalfTurns)), rounder);
  const V half_turns = hn::Sub(rounding, rounder);
  const auto quarter = hn::BitCast(u, rounding);
  const V t =
      hn::Mul(hn::Sub(degrees, hn::Mul(half_turns, hn::Set(d, 180.0))), hn::Set(d, kHalfRadians));
  const V square = hn::Mul(t, t);
  V p = hn::Set(d, kSine[0]);
  V q = hn::Set(d, kCosine[0]);
  for (int i = 1; i < 6; ++i) {
    p = hn::Add(hn::Mul(p, square), hn::Set(d, kSine[i]));
    q = hn::Add(hn::Mul(q, square), hn::Set(d, kCosine[i]));
  }
  const V s = hn::Add(t, hn::Mul(hn::Mul(t, square), p));
  const V c = hn::Sub(hn::Set(d, 1.0), hn::Sub(hn::Mul(hn::Set(d, 0.5), square),
                                               hn::Mul(hn::Mul(square, square), q)));
  const auto one = hn::Set(u, 1);
  const auto odd = hn::RebindMask(d, hn::Eq(hn::And(quarter, one), one));
  // Moves bits 0 and 1 to the sign bit.
  const auto sign = hn::Set(u, std::uint64_t{1} << 63);
  const V odd_sign = hn::BitCast(d, hn::ShiftLeft<63>(quarter));
  const V all_sign = hn::BitCast(d, hn::And(hn::ShiftLeft<62>(quarter), sign));
  sine = hn::Xor(hn::IfThenElse(odd, c, s), all_sign);
  cosine = hn::Xor(hn::IfThenElse(odd, s, c), hn::Xor(odd_sign, all_sign));
}

struct Frame {
  V px, py, pz, x, y, z, w;
};

HWY_INLINE Frame load_frame(const double* at) {
  const Doubles d;
  return {hn::Load(d, at),
          hn::Load(d, at + kLanes),
          hn::Load(d, at + 2 * kLanes),
          hn::Load(d, at + 3 * kLanes),
          hn::Load(d, at + 4 * kLanes),
          hn::Load(d, at + 5 * kLanes),
          hn::Load(d, at + 6 * kLanes)};
}

HWY_INLINE void store_frame(const Frame& frame, double* at) {
  const Doubles d;
  hn::Store(frame.px, d, at);
  hn::Store(frame.py, d, at + kLanes);
  hn::Store(frame.pz, d, at + 2 * kLanes);
  hn::Store(frame.x, d, at + 3 * kLanes);
  hn::Store(frame.y, d, at + 4 * kLanes);
  hn::Store(frame.z, d, at + 5 * kLanes);
  hn::Store(frame.w, d, at + 6 * kLanes);
}

// (a c + sign b s) and (a c - b s) for the rotations below.
HWY_INLINE V sum(V a, V c, V b, V s) {
  return hn::Add(hn::Mul(a, c), hn::Mul(b, s));
}
HWY_INLINE V difference(V a, V c, V b, V s) {
  return hn::Sub(hn::Mul(a, c), hn::Mul(b, s));
}

// The orientation times a rotation about a coordinate axis, which has two nonzero components.
HWY_INLINE void turn(Frame& frame, int axis, V s, V c) {
  const V x = frame.x, y = frame.y, z = frame.z, w = frame.w;
  if (axis == 0) {
    frame.w = difference(w, c, x, s);
    frame.x = sum(x, c, w, s);
    frame.y = sum(y, c, z, s);
    frame.z = difference(z, c, y, s);
  } else if (axis == 1) {
    frame.w = difference(w, c, y, s);
    frame.x = difference(x, c, z, s);
    frame.y = sum(y, c, w, s);
    frame.z = sum(z, c, x, s);
  } else {
    frame.w = difference(w, c, z, s);
    frame.x = sum(x, c, y, s);
    frame.y = difference(y, c, x, s);
    frame.z = sum(z, c, w, s);
  }
}

HWY_INLINE void normalize(Frame& frame) {
  const Doubles d;
  const V square =
      hn::Add(sum(frame.x, frame.x, frame.y, frame.y), sum(frame.z, frame.z, frame.w, frame.w));
  const V scale = hn::Div(hn::Set(d, 1.0), hn::Sqrt(square));
  frame.x = hn::Mul(frame.x, scale);
  frame.y = hn::Mul(frame.y, scale);
  frame.z = hn::Mul(frame.z, scale);
  frame.w = hn::Mul(frame.w, scale);
}

// parent * (x, y, z).
HWY_INLINE void place(const Frame& parent, V x, V y, V z, Frame& frame) {
  V ux = difference(parent.y, z, parent.z, y);
  V uy = difference(parent.z, x, parent.x, z);
  V uz = difference(parent.x, y, parent.y, x);
  ux = hn::Add(ux, ux);
  uy = hn::Add(uy, uy);
  uz = hn::Add(uz, uz);
  const V turned_x =
      hn::Add(hn::Add(x, hn::Mul(parent.w, ux)), difference(parent.y, uz, parent.z, uy));
  const V turned_y =
      hn::Add(hn::Add(y, hn::Mul(parent.w, uy)), difference(parent.z, ux, parent.x, uz));
  const V turned_z =
      hn::Add(hn::Add(z, hn::Mul(parent.w, uz)), difference(parent.x, uy, parent.y, ux));
  frame.px = hn::Add(turned_x, parent.px);
  frame.py = hn::Add(turned_y, parent.py);
  frame.pz = hn::Add(turned_z, parent.pz);
}

HWY_INLINE Frame joint_frame(const Job& job, std::size_t j, const Frame& parent,
                             const double* values, bool& near) {
  const Doubles d;
  Frame frame = parent;
  V offset[3] = {hn::Set(d, job.base[3 * j]), hn::Set(d, job.base[3 * j + 1]),
                 hn::Set(d, job.base[3 * j + 2])};
  auto unturned = job.parents[j] < 0 ? hn::FirstN(d, 0) : hn::FirstN(d, kLanes);
  for (std::size_t s = job.step_begins[j]; s < job.step_begins[j + 1]; ++s) {
    const Step& step = job.steps[s];
    const V value = hn::Load(d, values + step.channel * kFramesAtOnce);
    const V factor = hn::Set(d, step.factor);
    if (step.is_position) {
      offset[step.axis] = hn::Add(offset[step.axis], hn::Mul(value, factor));
      continue;
    }
    // Many channels are always zero.
    const auto zero = hn::Eq(value, hn::Zero(d));
    if (hn::AllTrue(d, zero)) continue;
    V sine, cosine;
    half_angles(hn::Mul(value, factor), sine, cosine, near);
    Frame turned = frame;
    turn(turned, step.axis, sine, cosine);
    frame.x = hn::IfThenElse(zero, frame.x, turned.x);
    frame.y = hn::IfThenElse(zero, frame.y, turned.y);
    frame.z = hn::IfThenElse(zero, frame.z, turned.z);
    frame.w = hn::IfThenElse(zero, frame.w, turned.w);
    unturned = hn::And(unturned, zero);
  }
  if (!hn::AllTrue(d, unturned)) {
    const Frame before = frame;
    normalize(frame);
    frame.x = hn::IfThenElse(unturned, before.x, frame.x);
    frame.y = hn::IfThenElse(unturned, before.y, frame.y);
    frame.z = hn::IfThenElse(unturned, before.z, frame.z);
    frame.w = hn::IfThenElse(unturned, before.w, frame.w);
  }
  place(parent, offset[0], offset[1], offset[2], frame);
  return frame;
}

// Stores a joint for `frames` frames, `joints` apart. Returns the sum of the absolute values of all
// components: if it is within a limit, so is every position.
HWY_INLINE V emit(const Frame& frame, std::size_t frames, std::size_t joints, float* positions,
                  float* orientations) {
  const Floats f;
  HWY_ALIGN float p[4 * kLanes], q[4 * kLanes];
  hn::StoreInterleaved4(hn::DemoteTo(f, frame.px), hn::DemoteTo(f, frame.py),
                        hn::DemoteTo(f, frame.pz), hn::Zero(f), f, p);
  hn::StoreInterleaved4(hn::DemoteTo(f, frame.x), hn::DemoteTo(f, frame.y),
                        hn::DemoteTo(f, frame.z), hn::DemoteTo(f, frame.w), f, q);
  for (std::size_t i = 0; i < frames; ++i) {
    std::memcpy(positions + i * joints * 3, p + 4 * i, 3 * sizeof(float));
    std::memcpy(orientations + i * joints * 4, q + 4 * i, 4 * sizeof(float));
  }
  return hn::Add(hn::Add(hn::Abs(frame.px), hn::Abs(frame.py)),
                 hn::Add(hn::Add(hn::Abs(frame.pz), hn::Abs(hn::Sub(frame.x, frame.y))),
                         hn::Abs(hn::Sub(frame.z, frame.w))));
}

bool poses(const Job& job, const double* values, std::size_t frames, float* positions,
           float* orientations) {
  const Doubles d;
  const V most = hn::Set(d, job.farthest);
  bool near = true;
  auto sound = hn::Le(hn::Zero(d), most);
  for (std::size_t first = 0; first < frames; first += kLanes) {
    const std::size_t used = frames - first < kLanes ? frames - first : kLanes;
    for (std::size_t j = 0; j < job.joints; ++j) {
      const Frame parent =
          job.parents[j] >= 0
              ? load_frame(job.scratch + static_cast<std::size_t>(job.parents[j]) * 7 * kLanes)
              : Frame{hn::Set(d, job.root[0]), hn::Set(d, job.root[1]), hn::Set(d, job.root[2]),
                      hn::Set(d, job.root[3]), hn::Set(d, job.root[4]), hn::Set(d, job.root[5]),
                      hn::Set(d, job.root[6])};
      const Frame frame = joint_frame(job, j, parent, values + first, near);
      store_frame(frame, job.scratch + j * 7 * kLanes);
      const std::size_t place = first * job.joints + j;
      const V size = emit(frame, used, job.joints, positions + 3 * place, orientations + 4 * place);
      sound = hn::And(sound, hn::Le(size, most));
    }
  }
  return near && hn::AllTrue(d, sound);
}

#else

bool poses(const Job& job, const double* values, std::size_t frames, float* positions,
           float* orientations) {
  return poses_scalar(job, values, frames, positions, orientations);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::bvh::kinematics_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::bvh::kinematics_detail {

bool poses(const Job& job, const double* values, std::size_t frames, float* positions,
           float* orientations) {
  const auto best = KROK_BEST_VERSION(poses);
  return best(job, values, frames, positions, orientations);
}

}  // namespace krok::bvh::kinematics_detail

#endif  // HWY_ONCE
