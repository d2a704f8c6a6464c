#include <cmath>

#include "pose/pose_kernels_internal.h"

namespace krok::pose_detail {

namespace {

constexpr int kLanes = PoseBlock::kLanes;

// Four components of one joint.
struct Rotation {
  float x, y, z, w;
};

Rotation rotation_of(const PoseBlock& block, int lane) {
  return {block.rotation[0][lane], block.rotation[1][lane], block.rotation[2][lane],
          block.rotation[3][lane]};
}

void set_rotation(PoseBlock& block, int lane, const Rotation& q) {
  block.rotation[0][lane] = q.x;
  block.rotation[1][lane] = q.y;
  block.rotation[2][lane] = q.z;
  block.rotation[3][lane] = q.w;
}

float dot(const Rotation& a, const Rotation& b) {
  return std::fma(a.x, b.x, std::fma(a.y, b.y, std::fma(a.z, b.z, a.w * b.w)));
}

float between(float before, float after, float part) {
  return std::fma(part, after, (1.0f - part) * before);
}

// Not normalised.
Rotation rotation_between(const PoseBlock& before, const PoseBlock& after, float part, int lane) {
  const Rotation a = rotation_of(before, lane);
  const Rotation b = rotation_of(after, lane);
  return {between(a.x, b.x, part), between(a.y, b.y, part), between(a.z, b.z, part),
          between(a.w, b.w, part)};
}

Rotation scaled(float factor, const Rotation& q) {
  return {factor * q.x, factor * q.y, factor * q.z, factor * q.w};
}

void add_scaled(float factor, const Rotation& q, Rotation& sum) {
  sum.x = std::fma(factor, q.x, sum.x);
  sum.y = std::fma(factor, q.y, sum.y);
  sum.z = std::fma(factor, q.z, sum.z);
  sum.w = std::fma(factor, q.w, sum.w);
}

void sample_scalar(const Between& term, std::size_t blocks, PoseBlock* pose) {
  for (std::size_t b = 0; b < blocks; ++b) {
    const PoseBlock& before = term.before[b];
    const PoseBlock& after = term.after[b];
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int i = 0; i < 3; ++i) {
        pose[b].position[i][lane] =
            between(before.position[i][lane], after.position[i][lane], term.part);
      }
      const Rotation q = rotation_between(before, after, term.part, lane);
      set_rotation(pose[b], lane, scaled(1.0f / std::sqrt(dot(q, q)), q));
    }
  }
}

float blend_scalar(const Between* terms, std::size_t count, Round round, const PoseBlock* reference,
                   std::size_t blocks, PoseBlock* sum) {
  float least = 1.0f;
  bool any = false;
  for (std::size_t b = 0; b < blocks; ++b) {
    for (int lane = 0; lane < kLanes; ++lane) {
      float position[3] = {};
      Rotation rotation = {};
      if (!round.first) {
        for (int i = 0; i < 3; ++i) position[i] = sum[b].position[i][lane];
        rotation = rotation_of(sum[b], lane);
      }
      const Rotation towards = rotation_of(reference[b], lane);
      for (std::size_t t = 0; t < count; ++t) {
        const PoseBlock& before = terms[t].before[b];
        const PoseBlock& after = terms[t].after[b];
        const float weight_after = terms[t].weight * terms[t].part;
        const float weight_before = terms[t].weight * (1.0f - terms[t].part);
        for (int i = 0; i < 3; ++i) {
          position[i] = std::fma(weight_after, after.position[i][lane],
                                 std::fma(weight_before, before.position[i][lane], position[i]));
        }
        const Rotation q = rotation_between(before, after, terms[t].part, lane);
        const float factor = terms[t].weight / std::sqrt(dot(q, q));
        add_scaled(dot(q, towards) < 0 ? -factor : factor, q, rotation);
      }
      for (int i = 0; i < 3; ++i) sum[b].position[i][lane] = position[i];
      if (round.last) {
        const float square = dot(rotation, rotation);
        const bool regular = square > kMinSquare;
        const float counted = regular ? square : 0.0f;
        least = any && least < counted ? least : counted;
        any = true;
        rotation = regular ? scaled(1.0f / std::sqrt(square), rotation) : towards;
      }
      set_rotation(sum[b], lane, rotation);
    }
  }
  return least;
}

void add_scalar(const PoseBlock* pose, float weight, const float* joint_weights,
                const PoseBlock* reference, std::size_t blocks, PoseBlock* sum) {
  for (std::size_t b = 0; b < blocks; ++b) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const float own = joint_weights == nullptr
                            ? weight
                            : weight * joint_weights[b * kLanes + static_cast<std::size_t>(lane)];
      for (int i = 0; i < 3; ++i) {
        sum[b].position[i][lane] =
            std::fma(own, pose[b].position[i][lane], sum[b].position[i][lane]);
      }
      const Rotation q = rotation_of(pose[b], lane);
      Rotation rotation = rotation_of(sum[b], lane);
      add_scaled(dot(q, rotation_of(reference[b], lane)) < 0 ? -own : own, q, rotation);
      set_rotation(sum[b], lane, rotation);
    }
  }
}

}  // namespace

Kernels scalar_kernels() {
  return {sample_scalar, blend_scalar, add_scalar};
}

}  // namespace krok::pose_detail
