#include <cmath>

#include "formats/bvh/half_angle.h"
#include "formats/bvh/kinematics_kernel.h"

namespace krok::bvh::kinematics_detail {

namespace {

struct Frame {
  double px, py, pz, x, y, z, w;
};

// The orientation times a rotation about a coordinate axis, which has two nonzero components, given
// by its half angle.
void turn(Frame& frame, int axis, double s, double c) {
  const double x = frame.x, y = frame.y, z = frame.z, w = frame.w;
  if (axis == 0) {
    frame.w = w * c - x * s;
    frame.x = x * c + w * s;
    frame.y = y * c + z * s;
    frame.z = z * c - y * s;
  } else if (axis == 1) {
    frame.w = w * c - y * s;
    frame.x = x * c - z * s;
    frame.y = y * c + w * s;
    frame.z = z * c + x * s;
  } else {
    frame.w = w * c - z * s;
    frame.x = x * c + y * s;
    frame.y = y * c - x * s;
    frame.z = z * c + w * s;
  }
}

// Products of many unit quaternions drift due to rounding, which matters in deep chains.
void normalize(Frame& frame) {
  const double square =
      (frame.x * frame.x + frame.y * frame.y) + (frame.z * frame.z + frame.w * frame.w);
  const double scale = 1.0 / std::sqrt(square);
  frame.x *= scale;
  frame.y *= scale;
  frame.z *= scale;
  frame.w *= scale;
}

// parent * (x, y, z).
void place(const Frame& parent, double x, double y, double z, Frame& frame) {
  double ux = parent.y * z - parent.z * y;
  double uy = parent.z * x - parent.x * z;
  double uz = parent.x * y - parent.y * x;
  ux += ux;
  uy += uy;
  uz += uz;
  frame.px = ((x + parent.w * ux) + (parent.y * uz - parent.z * uy)) + parent.px;
  frame.py = ((y + parent.w * uy) + (parent.z * ux - parent.x * uz)) + parent.py;
  frame.pz = ((z + parent.w * uz) + (parent.x * uy - parent.y * ux)) + parent.pz;
}

Frame joint_frame(const Job& job, std::size_t j, const Frame& parent, const double* values,
                  std::size_t stride) {
  Frame frame = parent;
  double offset[3] = {job.base[3 * j], job.base[3 * j + 1], job.base[3 * j + 2]};
  bool turned = job.parents[j] < 0;
  for (std::size_t s = job.step_begins[j]; s < job.step_begins[j + 1]; ++s) {
    const Step& step = job.steps[s];
    const double value = values[step.channel * stride];
    if (step.is_position) {
      offset[step.axis] += value * step.factor;
    } else if (value != 0) {  // many channels are always zero
      const HalfAngle half = half_angle(value * step.factor);
      turn(frame, step.axis, half.sine, half.cosine);
      turned = true;
    }
  }
  if (turned) normalize(frame);
  place(parent, offset[0], offset[1], offset[2], frame);
  return frame;
}

bool turns_far(const Job& job, const double* values) {
  for (std::size_t s = 0; s < job.step_begins[job.joints]; ++s) {
    const Step& step = job.steps[s];
    if (step.is_position) continue;
    if (std::abs(values[step.channel * kFramesAtOnce]) > half_angle_detail::kFarthestAngle) {
      return true;
    }
  }
  return false;
}

}  // namespace

void pose_scalar(const Job& job, const double* values, std::size_t stride, double* joints) {
  for (std::size_t j = 0; j < job.joints; ++j) {
    const double* parent =
        job.parents[j] < 0 ? job.root : joints + 7 * static_cast<std::size_t>(job.parents[j]);
    const Frame frame = joint_frame(
        job, j, {parent[0], parent[1], parent[2], parent[3], parent[4], parent[5], parent[6]},
        values, stride);
    double* at = joints + 7 * j;
    at[0] = frame.px;
    at[1] = frame.py;
    at[2] = frame.pz;
    at[3] = frame.x;
    at[4] = frame.y;
    at[5] = frame.z;
    at[6] = frame.w;
  }
}

bool poses_scalar(const Job& job, const double* values, std::size_t frames, float* positions,
                  float* orientations) {
  bool sound = true;
  for (std::size_t i = 0; i < frames; ++i) {
    pose_scalar(job, values + i, kFramesAtOnce, job.scratch);
    sound = sound && !turns_far(job, values + i);
    for (std::size_t j = 0; j < job.joints; ++j) {
      const double* at = job.scratch + 7 * j;
      const std::size_t place = i * job.joints + j;
      for (std::size_t k = 0; k < 3; ++k) positions[3 * place + k] = static_cast<float>(at[k]);
      for (std::size_t k = 0; k < 4; ++k) {
        orientations[4 * place + k] = static_cast<float>(at[3 + k]);
      }
      const double size =
          ((std::abs(at[0]) + std::abs(at[1])) + (std::abs(at[2]) + std::abs(at[3] - at[4]))) +
          std::abs(at[5] - at[6]);
      sound = sound && size <= job.farthest;
    }
  }
  return sound;
}

}  // namespace krok::bvh::kinematics_detail
