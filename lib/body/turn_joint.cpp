#include "body/turn_joint.h"

#include <cmath>
#include <vector>

#include "math/quaternion.h"

namespace krok::body {

void turn_joint(const Skeleton& skeleton, int joint, const Quat& rotation,
                std::span<Transform> joint_to_world) {
  const auto first = static_cast<std::size_t>(joint);
  const Vec3 pivot = joint_to_world[first].position;
  std::vector<char> below(joint_to_world.size(), 0);
  for (std::size_t j = first; j < joint_to_world.size(); ++j) {
    const int parent = skeleton.parents[j];
    below[j] = j == first || (parent >= 0 && below[static_cast<std::size_t>(parent)]) ? 1 : 0;
    if (!below[j]) continue;
    Transform& transform = joint_to_world[j];
    transform.position = pivot + rotation * (transform.position - pivot);
    transform.orientation = normalized_or_identity(rotation * transform.orientation);
  }
}

double turn_angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace krok::body
