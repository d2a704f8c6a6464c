#include "formats/acclaim/kinematics_internal.h"

#include <cmath>
#include <string>

#include "capture/far_values.h"
#include "capture/unique_names.h"
#include "math/quaternion.h"

namespace krok::acclaim {

namespace {

bool needs_end(const SkeletonFile::Joint& joint) {
  return joint.parent >= 0 && !joint.has_children;
}

}  // namespace

std::size_t joint_count_with_ends(const SkeletonFile& skeleton) {
  std::size_t count = skeleton.joints.size();
  for (const auto& joint : skeleton.joints) count += needs_end(joint) ? 1 : 0;
  return count;
}

Kinematics::Kinematics(const SkeletonFile& skeleton, double radians)
    : file_(skeleton), radians_(radians) {
  std::vector<int> clip_joint(skeleton.joints.size());
  std::vector<std::size_t> length_channel(skeleton.joints.size(), kFixed);
  std::size_t channel = 0;
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const SkeletonFile::Joint& source = skeleton.joints[i];
    const auto parent = static_cast<std::size_t>(source.parent);
    Joint joint;
    joint.source = static_cast<int>(i);
    joint.first_channel = channel;
    if (source.parent >= 0) {
      joint.parent = clip_joint[parent];
      joint.parent_length = length_channel[parent];
    }
    clip_joint[i] = static_cast<int>(joints_.size());
    joints_.push_back(joint);
    for (const Channel c : source.channels) {
      if (c == Channel::length) length_channel[i] = channel;
      ++channel;
    }
    if (!needs_end(source)) continue;
    Joint end;
    end.parent = clip_joint[i];
    end.source = static_cast<int>(i);
    end.is_end = true;
    end.parent_length = length_channel[i];
    joints_.push_back(end);
  }
}

// From the start of a bone to its end, in the reference pose.
Vec3 Kinematics::bone_end(int file_joint, double length) const {
  const SkeletonFile::Joint& joint = file_.joints[static_cast<std::size_t>(file_joint)];
  // The root is a point without length.
  return joint.parent < 0 ? Vec3(Vec3::Zero()) : Vec3(joint.direction * length);
}

Skeleton Kinematics::skeleton() const {
  UniqueNames names;
  for (const auto& joint : file_.joints) names.claim(joint.name);
  Skeleton skeleton;
  for (const Joint& joint : joints_) {
    const SkeletonFile::Joint& source = file_.joints[static_cast<std::size_t>(joint.source)];
    Transform world{file_.root_position, file_.root_orientation};
    std::string name = source.name;
    if (joint.parent >= 0) {
      const int bone = joint.is_end ? joint.source : source.parent;
      const double length = file_.joints[static_cast<std::size_t>(bone)].length;
      world.position =
          skeleton.reference[static_cast<std::size_t>(joint.parent)] * bone_end(bone, length);
    }
    if (joint.is_end) {
      name += "_end";
      name = names.make(name);
    }
    skeleton.add(std::move(name), joint.parent, world, joint.is_end);
  }
  return skeleton;
}

void Kinematics::pose(std::span<const double> values, std::span<Transform> joint_to_world) const {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const SkeletonFile::Joint& source = file_.joints[static_cast<std::size_t>(joint.source)];
    Transform local;
    if (!joint.is_end) {
      Vec3 translation = Vec3::Zero();
      Quat rotation = Quat::Identity();
      for (std::size_t c = 0; c < source.channels.size(); ++c) {
        const Channel channel = source.channels[c];
        const double value = values[joint.first_channel + c];
        if (is_translation(channel)) {
          translation[axis_index(channel)] = value;
        } else if (is_rotation(channel)) {
          rotation =
              axis_rotation(static_cast<Axis>(axis_index(channel)), value * radians_) * rotation;
        }
      }
      local.position = source.axes * translation;
      local.orientation = source.axes * rotation * source.axes.conjugate();
    }
    if (joint.parent < 0) {
      local = Transform{file_.root_position, file_.root_orientation} * local;
      joint_to_world[j] = local;
    } else {
      const int bone = joint.is_end ? joint.source : source.parent;
      const double length = joint.parent_length == kFixed
                                ? file_.joints[static_cast<std::size_t>(bone)].length
                                : values[joint.parent_length];
      local.position += bone_end(bone, length);
      joint_to_world[j] = joint_to_world[static_cast<std::size_t>(joint.parent)] * local;
    }
    // Products of many unit quaternions drift due to rounding, which matters in deep chains.
    joint_to_world[j].orientation.normalize();
  }
}

std::optional<Kinematics::Rotation> Kinematics::far_rotation(std::span<const double> values) const {
  const double farthest = kFarthestRotation * kRadiansPerDegree / radians_;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (joints_[j].is_end) continue;
    const auto& channels = file_.joints[static_cast<std::size_t>(joints_[j].source)].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const double size = std::abs(values[joints_[j].first_channel + c]);
      if (!is_rotation(channels[c]) || size <= farthest) continue;
      return Rotation{j, channels[c], size * radians_ / kRadiansPerDegree};
    }
  }
  return {};
}

}  // namespace krok::acclaim
