#include "formats/bvh/kinematics.h"

#include <cmath>

namespace krok::bvh {

namespace {

struct SignedAxis {
  Axis axis;
  double sign;
};

// Where the file's axis points in Krok's frame.
SignedAxis converted(Axis axis, const Mat3& to_krok) {
  const Vec3 direction = to_krok.col(static_cast<int>(axis));
  int index = 0;
  direction.cwiseAbs().maxCoeff(&index);
  return {static_cast<Axis>(index), direction[index] < 0 ? -1.0 : 1.0};
}

// q times the rotation by `angle` about an axis, which has two components only.
Quat turned(const Quat& q, Axis axis, double angle) {
  const double c = std::cos(0.5 * angle);
  const double s = std::sin(0.5 * angle);
  const double w = q.w(), x = q.x(), y = q.y(), z = q.z();
  switch (axis) {
    case Axis::x:
      return {w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s};
    case Axis::y:
      return {w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s};
    case Axis::z:
      break;
  }
  return {w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s};
}

}  // namespace

Kinematics::Kinematics(const Hierarchy& hierarchy, Positions positions,
                       const Conversion& conversion)
    : reference_to_motion_(conversion.reference_to_motion()) {
  const Mat3& to_krok = conversion.reference_axes();
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
      steps_.push_back({index, channel.kind, axis.axis,
                        axis.sign * (is_position ? conversion.metres() : kRadiansPerDegree)});
    }
    offsets_.push_back(to_krok * (joint.offset * conversion.metres()));
    base_.push_back(to_krok * (kept * conversion.metres()));
    step_begins_.push_back(steps_.size());
  }
}

void Kinematics::pose(std::span<const double> values, std::span<Transform> joint_to_world) const {
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    const Transform& parent = parents_[j] < 0
                                  ? reference_to_motion_
                                  : joint_to_world[static_cast<std::size_t>(parents_[j])];
    Vec3 position = base_[j];
    Quat orientation = parent.orientation;
    bool has_turned = parents_[j] < 0;
    for (std::size_t s = step_begins_[j]; s < step_begins_[j + 1]; ++s) {
      const Step& step = steps_[s];
      const double value = values[step.channel] * step.factor;
      if (step.kind == ChannelKind::position) {
        position[static_cast<int>(step.axis)] += value;
      } else if (value != 0) {  // many channels are never used
        orientation = turned(orientation, step.axis, value);
        has_turned = true;
      }
    }
    // Products of many unit quaternions drift by rounding; deep chains would notice.
    if (has_turned) orientation.normalize();
    joint_to_world[j] = {parent * position, orientation};
  }
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
