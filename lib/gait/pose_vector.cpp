#include "gait/pose_vector_internal.h"

#include "core/index.h"

namespace krok::gait {

Transform joint_of(const PoseVector& pose, int joint) {
  Transform result;
  result.position = position_of(pose, joint);
  result.orientation.coeffs() = rotation_of(pose, joint).normalized();
  return result;
}

Transform joint_to_world(const Skeleton& skeleton, const PoseVector& pose, int joint) {
  Transform result;
  for (int j = joint; j >= 0; j = skeleton.parents[at(j)]) result = joint_of(pose, j) * result;
  return result;
}

}  // namespace krok::gait
