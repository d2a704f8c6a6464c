#pragma once

#include <optional>
#include <span>
#include <vector>

#include "formats/acclaim/files_internal.h"
#include "math/transform.h"
#include "scene/skeleton.h"

namespace krok::acclaim {

// Forward kinematics for the joints of a clip made from an ASF: the file's joints in order, each
// leaf followed by its end joint. In the file's unit and axes.
class Kinematics {
 public:
  // `radians` is the angle unit of the motion in radians. The skeleton must outlive this.
  Kinematics(const SkeletonFile& skeleton, double radians);

  std::size_t joint_count() const { return joints_.size(); }

  // Names, parents and end sites, with the reference pose.
  Skeleton skeleton() const;

  // The file joint of a clip joint, or -1 for an end joint.
  int file_joint(std::size_t joint) const {
    return joints_[joint].is_end ? -1 : joints_[joint].source;
  }

  // joint_to_world, shape [joints], from the values of a frame, shape [channels], in doubles.
  void pose(std::span<const double> values, std::span<Transform> joint_to_world) const;

  // The first rotation beyond kFarthestRotation in the values of a frame (capture/far_values.h).
  struct Rotation {
    std::size_t joint = 0;  // of the clip
    Channel channel = Channel::rx;
    double degrees = 0;  // positive
  };
  std::optional<Rotation> far_rotation(std::span<const double> values) const;

 private:
  struct Joint {
    int parent = -1;
    int source = 0;  // joint of the file; the leaf for an end joint
    bool is_end = false;
    std::size_t first_channel = 0;
    // Channel of the parent bone's length, if it can stretch.
    std::size_t parent_length = kFixed;
  };
  static constexpr std::size_t kFixed = static_cast<std::size_t>(-1);

  Vec3 bone_end(int file_joint, double length) const;

  const SkeletonFile& file_;
  double radians_;
  std::vector<Joint> joints_;
};

// Number of joints of the clip.
std::size_t joint_count_with_ends(const SkeletonFile& skeleton);

}  // namespace krok::acclaim
