#include "formats/bvh/kinematics.h"

#include <algorithm>
#include <memory>

#include "capture/far_values.h"
#include "formats/bvh/half_angle.h"

namespace krok::bvh {

namespace {

struct SignedAxis {
  Axis axis;
  double sign;
};

// The file's axis in Krok's frame.
SignedAxis converted(Axis axis, const Mat3& to_krok) {
  const Vec3 direction = to_krok.col(static_cast<int>(axis));
  int index = 0;
  direction.cwiseAbs().maxCoeff(&index);
  return {static_cast<Axis>(index), direction[index] < 0 ? -1.0 : 1.0};
}

}  // namespace

Kinematics::Kinematics(const Hierarchy& hierarchy, Positions positions,
                       const Conversion& conversion)
    : reference_to_motion_(conversion.reference_to_motion()),
      degrees_per_angle_(hierarchy.degrees_per_angle) {
  const Mat3& to_krok = conversion.reference_axes();
  parents_.reserve(hierarchy.joints.size());
  offsets_.reserve(hierarchy.joints.size());
  base_.reserve(hierarchy.joints.size());
  steps_.reserve(hierarchy.channels.size());
  step_begins_.reserve(hierarchy.joints.size() + 1);
  step_begins_.push_back(0);
  for (const Hierarchy::Joint& joint : hierarchy.joints) {
    parents_.push_back(joint.parent);
    Vec3 kept = joint.offset;
    for (std::size_t i = 0; i < joint.channel_count; ++i) {
      const std::size_t index = joint.first_channel + i;
      const Channel& channel = hierarchy.channels[index];
      if (channel.kind == ChannelKind::ignored) continue;
      const bool is_position = channel.kind == ChannelKind::position;
      if (is_position && positions != Positions::additive) {
        kept[static_cast<int>(channel.axis)] = 0;
      }
      const SignedAxis axis = converted(channel.axis, to_krok);
      steps_.push_back({index, is_position, static_cast<int>(axis.axis),
                        axis.sign * (is_position ? conversion.metres() : 1.0)});
    }
    offsets_.push_back(to_krok * (joint.offset * conversion.metres()));
    base_.push_back(to_krok * (kept * conversion.metres()));
    step_begins_.push_back(steps_.size());
  }
  farthest_ = farthest_position(reference());
}

void Kinematics::expect_within(double usual_distance) {
  usual_distance_ = usual_distance;
  farthest_ = farthest_position(reference(), usual_distance);
}

kinematics_detail::Job Kinematics::job(double* scratch) const {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const Vec3& p = reference_to_motion_.position;
  const Quat& q = reference_to_motion_.orientation;
  return {parents_.data(),
          parents_.size(),
          base_.data()->data(),
          steps_.data(),
          step_begins_.data(),
          {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()},
          scratch,
          farthest_};
}

std::optional<Kinematics::Rotation> Kinematics::far_rotation(const double* values,
                                                             std::size_t stride) const {
  // poses() must flag every rotation that this function looks for.
  static_assert(half_angle_detail::kFarthestAngle <= kFarthestRotation);
  std::optional<Rotation> found;
  for (const kinematics_detail::Step& step : steps_) {
    if (step.is_position || (found && found->channel < step.channel)) continue;
    const double degrees = std::abs(values[step.channel * stride] * degrees_per_angle_);
    if (degrees > kFarthestRotation) found = Rotation{step.channel, degrees};
  }
  return found;
}

void Kinematics::put_in_degrees(std::span<double> values, std::size_t stride) const {
  for (const kinematics_detail::Step& step : steps_) {
    if (step.is_position) continue;
    for (double& value : values.subspan(step.channel * stride, stride)) value *= degrees_per_angle_;
  }
}

void Kinematics::pose(std::span<const double> values, std::span<Transform> joint_to_world) const {
  std::vector<double> joints(7 * parents_.size());
  std::vector<double> in_degrees;
  if (degrees_per_angle_ != 1.0) {
    in_degrees.assign(values.begin(), values.end());
    put_in_degrees(in_degrees, 1);
    values = in_degrees;
  }
  kinematics_detail::pose_scalar(job(nullptr), values.data(), 1, joints.data());
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    const double* at = &joints[7 * j];
    joint_to_world[j] = {Vec3(at[0], at[1], at[2]), Quat(at[6], at[3], at[4], at[5])};
  }
}

bool Kinematics::poses(std::span<const double> values, std::size_t frames,
                       std::vector<double>& scratch, std::span<Vec3f> positions,
                       std::span<Quatf> orientations) const {
  constexpr std::size_t kAlignment = 64 / sizeof(double);
  const bool other_angles = degrees_per_angle_ != 1.0;
  const std::size_t for_joints = 7 * kFramesAtOnce * parents_.size();
  static_assert(kFramesAtOnce % kAlignment == 0);
  scratch.resize(for_joints + kAlignment + (other_angles ? values.size() : 0));
  void* aligned = scratch.data();
  std::size_t space = scratch.size() * sizeof(double);
  std::align(kAlignment * sizeof(double), 1, aligned, space);
  if (other_angles) {
    const std::span in_degrees(static_cast<double*>(aligned) + for_joints, values.size());
    std::copy(values.begin(), values.end(), in_degrees.begin());
    put_in_degrees(in_degrees, kFramesAtOnce);
    values = in_degrees;
  }
  return kinematics_detail::poses(job(static_cast<double*>(aligned)), values.data(), frames,
                                  positions.data()->data(), orientations.data()->coeffs().data());
}

std::vector<Transform> Kinematics::reference() const {
  std::vector<Transform> joint_to_world(parents_.size());
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    joint_to_world[j].position = offsets_[j];
    if (parents_[j] >= 0) {
      joint_to_world[j].position += joint_to_world[static_cast<std::size_t>(parents_[j])].position;
    }
  }
  return joint_to_world;
}

}  // namespace krok::bvh

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
