#include "pose/pose_kernels_internal.h"

// As in pose_kernels.cpp: targets without FMA use the scalar reference.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose/model_kernel.cpp"
#include <hwy/foreach_target.h>
// The order matters: foreach_target.h sets up what highway.h reads.
#include <hwy/highway.h>

#include "core/simd.h"
// Needs highway.h.
#include "math/lanes.inc"

HWY_BEFORE_NAMESPACE();
namespace krok::pose_detail {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA

namespace hn = hwy::HWY_NAMESPACE;

// A lane is a pose.
using Lanes = hn::CappedTag<float, PoseBlock::kLanes>;
using V = hn::Vec<Lanes>;
using Four = hn::FixedTag<float, 4>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());
constexpr std::size_t kPoses = PoseBlock::kLanes;

struct Joint {
  V px, py, pz, x, y, z, w;
};

HWY_INLINE void transpose_fours(V& a, V& b, V& c, V& d) {
  math_detail::HWY_NAMESPACE::transpose_fours(Lanes(), a, b, c, d);
}

// Calls take(part, four) for each group of four lanes, lowest first.
template <class D, class Take>
HWY_INLINE void each_four(D d, hn::Vec<D> v, std::size_t first, const Take& take) {
  if constexpr (hn::MaxLanes(d) == 4) {
    take(first, v);
  } else {
    const hn::Half<D> half;
    each_four(half, hn::LowerHalf(half, v), first, take);
    each_four(half, hn::UpperHalf(half, v), first + hn::MaxLanes(d) / 8, take);
  }
}

// Transposes one component of sixteen joints in sixteen poses, `used` of which exist, from a row
// per pose to a row per joint. `row` returns a block's row for that component.
template <class Row>
HWY_INLINE void turn_rows(const PoseBlock* poses, std::size_t stride, std::size_t used,
                          PoseBlock* joints, const Row& row) {
  const Lanes d;
  for (std::size_t pose = 0; pose < kPoses; pose += 4) {
    // Missing poses repeat the last one.
    const PoseBlock* from[4];
    for (std::size_t i = 0; i < 4; ++i) {
      from[i] = poses + (pose + i < used ? pose + i : used - 1) * stride;
    }
    for (std::size_t lane = 0; lane < kPoses; lane += kLanes) {
      V r[4];
      for (std::size_t i = 0; i < 4; ++i) r[i] = hn::Load(d, row(*from[i]) + lane);
      transpose_fours(r[0], r[1], r[2], r[3]);
      for (std::size_t i = 0; i < 4; ++i) {
        each_four(d, r[i], 0, [&](std::size_t part, hn::Vec<Four> four) HWY_ATTR {
          hn::Store(four, Four(), row(joints[lane + 4 * part + i]) + pose);
        });
      }
    }
  }
}

HWY_INLINE Joint load(const PoseBlock& block, std::size_t lane) {
  const Lanes d;
  return {hn::Load(d, block.position[0] + lane), hn::Load(d, block.position[1] + lane),
          hn::Load(d, block.position[2] + lane), hn::Load(d, block.rotation[0] + lane),
          hn::Load(d, block.rotation[1] + lane), hn::Load(d, block.rotation[2] + lane),
          hn::Load(d, block.rotation[3] + lane)};
}

HWY_INLINE void store(const Joint& joint, PoseBlock& block, std::size_t lane) {
  const Lanes d;
  hn::Store(joint.px, d, block.position[0] + lane);
  hn::Store(joint.py, d, block.position[1] + lane);
  hn::Store(joint.pz, d, block.position[2] + lane);
  hn::Store(joint.x, d, block.rotation[0] + lane);
  hn::Store(joint.y, d, block.rotation[1] + lane);
  hn::Store(joint.z, d, block.rotation[2] + lane);
  hn::Store(joint.w, d, block.rotation[3] + lane);
}

HWY_INLINE Joint combined(const Joint& parent, const Joint& local) {
  const auto difference = [](V a, V b, V c, V d)
                              HWY_ATTR { return hn::MulSub(a, b, hn::Mul(c, d)); };
  V ux = difference(parent.y, local.pz, parent.z, local.py);
  V uy = difference(parent.z, local.px, parent.x, local.pz);
  V uz = difference(parent.x, local.py, parent.y, local.px);
  ux = hn::Add(ux, ux);
  uy = hn::Add(uy, uy);
  uz = hn::Add(uz, uz);
  // v + w u + q x u.
  const auto turned = [](V v, V w, V u, V qa, V ub, V qb, V ua) HWY_ATTR {
    return hn::NegMulAdd(qb, ua, hn::MulAdd(qa, ub, hn::MulAdd(w, u, v)));
  };
  const auto sum = [](V ab, V c, V d, V e, V f, V g, V h) HWY_ATTR {
    return hn::NegMulAdd(g, h, hn::MulAdd(e, f, hn::MulAdd(c, d, ab)));
  };
  Joint joint;
  joint.px = turned(hn::Add(parent.px, local.px), parent.w, ux, parent.y, uz, parent.z, uy);
  joint.py = turned(hn::Add(parent.py, local.py), parent.w, uy, parent.z, ux, parent.x, uz);
  joint.pz = turned(hn::Add(parent.pz, local.pz), parent.w, uz, parent.x, uy, parent.y, ux);
  joint.x =
      sum(hn::Mul(parent.w, local.x), parent.x, local.w, parent.y, local.z, parent.z, local.y);
  joint.y =
      sum(hn::Mul(parent.w, local.y), parent.y, local.w, parent.z, local.x, parent.x, local.z);
  joint.z =
      sum(hn::Mul(parent.w, local.z), parent.z, local.w, parent.x, local.y, parent.y, local.x);
  joint.w =
      hn::NegMulAdd(parent.z, local.z,
                    hn::NegMulAdd(parent.y, local.y,
                                  hn::NegMulAdd(parent.x, local.x, hn::Mul(parent.w, local.w))));
  return joint;
}

// Transposes four components of a joint in kLanes poses to four floats per pose, and calls
// put(pose, four) for each.
template <class Put>
HWY_INLINE void each_pose(V a, V b, V c, V d, const Put& put) {
  transpose_fours(a, b, c, d);
  const V rows[4] = {a, b, c, d};
  for (std::size_t i = 0; i < 4; ++i) {
    each_four(Lanes(), rows[i], 0,
              [&](std::size_t part, hn::Vec<Four> four) HWY_ATTR { put(4 * part + i, four); });
  }
}

// Stores three of four lanes; `more` allows the fourth to be overwritten.
HWY_INLINE void store_three(hn::Vec<Four> value, float* to, bool more) {
  const Four d;
  if (more) {
    hn::StoreU(value, d, to);
  } else {
    HWY_ALIGN float four[4];
    hn::Store(value, d, four);
    to[0] = four[0];
    to[1] = four[1];
    to[2] = four[2];
  }
}

// Writes the result of a joint in up to kLanes poses, starting at `pose`.
HWY_INLINE void put_transform(const ModelJob& job, const Joint& joint, std::size_t j,
                              std::size_t pose, std::size_t used) {
  const bool more = j + 1 < job.joints;
  const std::size_t first = pose * job.joints + j;
  each_pose(joint.px, joint.py, joint.pz, joint.pz, [&](std::size_t i, hn::Vec<Four> p) HWY_ATTR {
    if (i < used) store_three(p, job.positions + 3 * (first + i * job.joints), more);
  });
  each_pose(joint.x, joint.y, joint.z, joint.w, [&](std::size_t i, hn::Vec<Four> q) HWY_ATTR {
    if (i < used) hn::StoreU(q, Four(), job.orientations + 4 * (first + i * job.joints));
  });
}

HWY_INLINE void put_matrix(const ModelJob& job, const Joint& joint, std::size_t j, std::size_t pose,
                           std::size_t used) {
  const V one = hn::Set(Lanes(), 1.0f);
  const V x2 = hn::Add(joint.x, joint.x);
  const V y2 = hn::Add(joint.y, joint.y);
  const V z2 = hn::Add(joint.z, joint.z);
  const V xx = hn::Mul(joint.x, x2), yy = hn::Mul(joint.y, y2), zz = hn::Mul(joint.z, z2);
  const V xy = hn::Mul(joint.x, y2), xz = hn::Mul(joint.x, z2), yz = hn::Mul(joint.y, z2);
  JointMatrix* first = job.matrices + pose * job.joints + j;
  const auto put = [&](int row) HWY_ATTR {
    return [=, &job](std::size_t i, hn::Vec<Four> values) HWY_ATTR {
      if (i < used) hn::Store(values, Four(), first[i * job.joints].rows[row]);
    };
  };
  each_pose(hn::Sub(one, hn::Add(yy, zz)), hn::NegMulAdd(joint.w, z2, xy),
            hn::MulAdd(joint.w, y2, xz), joint.px, put(0));
  each_pose(hn::MulAdd(joint.w, z2, xy), hn::Sub(one, hn::Add(xx, zz)),
            hn::NegMulAdd(joint.w, x2, yz), joint.py, put(1));
  each_pose(hn::NegMulAdd(joint.w, y2, xz), hn::MulAdd(joint.w, x2, yz),
            hn::Sub(one, hn::Add(xx, yy)), joint.pz, put(2));
}

void local_to_model(const ModelJob& job) {
  const std::size_t blocks = (job.joints + kPoses - 1) / kPoses;
  for (std::size_t pose = 0; pose < job.count; pose += kPoses) {
    const std::size_t used = job.count - pose < kPoses ? job.count - pose : kPoses;
    for (std::size_t b = 0; b < blocks; ++b) {
      const PoseBlock* from = job.poses + pose * blocks + b;
      PoseBlock* to = job.scratch + b * kPoses;
      for (int i = 0; i < 3; ++i) {
        turn_rows(from, blocks, used, to, [i](auto& block) HWY_ATTR { return block.position[i]; });
      }
      for (int i = 0; i < 4; ++i) {
        turn_rows(from, blocks, used, to, [i](auto& block) HWY_ATTR { return block.rotation[i]; });
      }
    }
    for (std::size_t j = 0; j < job.joints; ++j) {
      const int parent = job.parents[j];
      for (std::size_t lane = 0; lane < used; lane += kLanes) {
        Joint joint = load(job.scratch[j], lane);
        if (parent >= 0) {
          joint = combined(load(job.scratch[static_cast<std::size_t>(parent)], lane), joint);
          store(joint, job.scratch[j], lane);
        }
        const std::size_t left = used - lane < kLanes ? used - lane : kLanes;
        if (job.matrices != nullptr) {
          put_matrix(job, joint, j, pose + lane, left);
        } else {
          put_transform(job, joint, j, pose + lane, left);
        }
      }
    }
  }
}

#else

void local_to_model(const ModelJob& job) {
  local_to_model_scalar(job);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::pose_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::pose_detail {

void local_to_model_simd(const ModelJob& job) {
  const auto best = KROK_BEST_VERSION(local_to_model);
  best(job);
}

}  // namespace krok::pose_detail

#endif  // HWY_ONCE
