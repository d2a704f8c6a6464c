#pragma once

#include <Eigen/Core>

#include "math/transform.h"
#include "scene/skeleton.h"

// A pose is one vector: joint_to_parent of each joint of the libraries' packed skeleton (rooted at
// the hips), position x, y, z and quaternion x, y, z, w; the root's is joint_to_world. Corrections
// are added to it, quaternions too, and normalised afterwards, so that sums of curves with two
// continuous derivatives have them as well.

namespace krok::gait {

using PoseVector = Eigen::VectorXd;
inline constexpr Eigen::Index kPoseValues = 7;  // a joint

inline auto position_of(const PoseVector& pose, int joint) {
  return pose.segment<3>(kPoseValues * joint);
}
inline auto position_of(PoseVector& pose, int joint) {
  return pose.segment<3>(kPoseValues * joint);
}
inline auto rotation_of(const PoseVector& pose, int joint) {
  return pose.segment<4>(kPoseValues * joint + 3);
}
inline auto rotation_of(PoseVector& pose, int joint) {
  return pose.segment<4>(kPoseValues * joint + 3);
}
Transform joint_of(const PoseVector& pose, int joint);  // rotation normalised

Transform joint_to_world(const Skeleton& skeleton, const PoseVector& pose, int joint);

}  // namespace krok::gait
