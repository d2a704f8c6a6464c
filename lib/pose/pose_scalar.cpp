#include <cassert>
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

void add_scalar(const PoseBlock* pose, float weight, const PoseBlock* reference, std::size_t blocks,
                PoseBlock* sum) {
  for (std::size_t b = 0; b < blocks; ++b) {
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int i = 0; i < 3; ++i) {
        sum[b].position[i][lane] =
            std::fma(weight, pose[b].position[i][lane], sum[b].position[i][lane]);
      }
      const Rotation q = rotation_of(pose[b], lane);
      Rotation rotation = rotation_of(sum[b], lane);
      add_scaled(dot(q, rotation_of(reference[b], lane)) < 0 ? -weight : weight, q, rotation);
      set_rotation(sum[b], lane, rotation);
    }
  }
}

}  // namespace

Kernels scalar_kernels() {
  return {sample_scalar, blend_scalar, add_scalar};
}

namespace {

struct Joint {
  float p[3];
  float x, y, z, w;
};

// a b - c d, with the second product rounded before the subtraction.
float difference(float a, float b, float c, float d) {
  return std::fma(a, b, -(c * d));
}

// v + w u + q x u, one product at a time.
float turned(float v, float w, float u, float qa, float ub, float qb, float ua) {
  return std::fma(-qb, ua, std::fma(qa, ub, std::fma(w, u, v)));
}

Joint combined(const Joint& parent, const Joint& local) {
  const float* v = local.p;
  float ux = difference(parent.y, v[2], parent.z, v[1]);
  float uy = difference(parent.z, v[0], parent.x, v[2]);
  float uz = difference(parent.x, v[1], parent.y, v[0]);
  ux += ux;
  uy += uy;
  uz += uz;
  const auto sum = [](float ab, float c, float d, float e, float f, float g, float h) {
    return std::fma(-g, h, std::fma(e, f, std::fma(c, d, ab)));
  };
  Joint joint;
  joint.p[0] = turned(parent.p[0] + v[0], parent.w, ux, parent.y, uz, parent.z, uy);
  joint.p[1] = turned(parent.p[1] + v[1], parent.w, uy, parent.z, ux, parent.x, uz);
  joint.p[2] = turned(parent.p[2] + v[2], parent.w, uz, parent.x, uy, parent.y, ux);
  joint.x = sum(parent.w * local.x, parent.x, local.w, parent.y, local.z, parent.z, local.y);
  joint.y = sum(parent.w * local.y, parent.y, local.w, parent.z, local.x, parent.x, local.z);
  joint.z = sum(parent.w * local.z, parent.z, local.w, parent.x, local.y, parent.y, local.x);
  joint.w =
      std::fma(-parent.z, local.z,
               std::fma(-parent.y, local.y, std::fma(-parent.x, local.x, parent.w * local.w)));
  return joint;
}

void set_matrix(const Joint& joint, JointMatrix& matrix) {
  const float x2 = joint.x + joint.x, y2 = joint.y + joint.y, z2 = joint.z + joint.z;
  const float xx = joint.x * x2, yy = joint.y * y2, zz = joint.z * z2;
  const float xy = joint.x * y2, xz = joint.x * z2, yz = joint.y * z2;
  const float rows[3][4] = {
      {1.0f - (yy + zz), std::fma(-joint.w, z2, xy), std::fma(joint.w, y2, xz), joint.p[0]},
      {std::fma(joint.w, z2, xy), 1.0f - (xx + zz), std::fma(-joint.w, x2, yz), joint.p[1]},
      {std::fma(-joint.w, y2, xz), std::fma(joint.w, x2, yz), 1.0f - (xx + yy), joint.p[2]}};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) matrix.rows[r][c] = rows[r][c];
  }
}

Joint joint_of(const PoseBlock& block, std::size_t lane) {
  return {{block.position[0][lane], block.position[1][lane], block.position[2][lane]},
          block.rotation[0][lane],
          block.rotation[1][lane],
          block.rotation[2][lane],
          block.rotation[3][lane]};
}

void set_joint(const Joint& joint, PoseBlock& block, std::size_t lane) {
  for (int i = 0; i < 3; ++i) block.position[i][lane] = joint.p[i];
  block.rotation[0][lane] = joint.x;
  block.rotation[1][lane] = joint.y;
  block.rotation[2][lane] = joint.z;
  block.rotation[3][lane] = joint.w;
}

}  // namespace

void local_to_model_scalar(const ModelJob& job) {
  assert(job.count == 0 || job.matrices != nullptr || job.positions != nullptr);
  constexpr std::size_t kLanes = PoseBlock::kLanes;
  const std::size_t blocks = (job.joints + kLanes - 1) / kLanes;
  for (std::size_t pose = 0; pose < job.count; ++pose) {
    for (std::size_t j = 0; j < job.joints; ++j) {
      Joint joint = joint_of(job.poses[pose * blocks + j / kLanes], j % kLanes);
      if (job.parents[j] >= 0) {
        const auto parent = static_cast<std::size_t>(job.parents[j]);
        joint = combined(joint_of(job.scratch[parent / kLanes], parent % kLanes), joint);
      }
      set_joint(joint, job.scratch[j / kLanes], j % kLanes);
      const std::size_t place = pose * job.joints + j;
      if (job.matrices != nullptr) {
        set_matrix(joint, job.matrices[place]);
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) job.positions[3 * place + i] = joint.p[i];
      float* q = job.orientations + 4 * place;
      q[0] = joint.x;
      q[1] = joint.y;
      q[2] = joint.z;
      q[3] = joint.w;
    }
  }
}

}  // namespace krok::pose_detail
