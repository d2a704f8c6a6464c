#include "skin/palette.h"

#include <cassert>

namespace krok {

std::vector<Transform> inverse_reference(const Skeleton& skeleton) {
  std::vector<Transform> inverses;
  inverses.reserve(skeleton.reference.size());
  for (const Transform& joint_to_world : skeleton.reference) {
    inverses.push_back(joint_to_world.inverse());
  }
  return inverses;
}

void make_palette(std::span<const Transform> reference_to_joint,
                  std::span<const Transform> joint_to_world, std::span<SkinMatrix> palette) {
  assert(reference_to_joint.size() == palette.size());
  assert(joint_to_world.size() == palette.size());
  for (std::size_t j = 0; j < palette.size(); ++j) {
    const Mat4f matrix = (joint_to_world[j] * reference_to_joint[j]).matrix().cast<float>();
    Eigen::Map<Mat4f>(palette[j].elements) = matrix;
  }
}

SkinMatrix skin_matrix(const Transform& reference_to_joint, const Transform& rigid,
                       const Stretch& stretch) {
  SkinMatrix result;
  const Mat4 whole = joint_to_world(rigid, stretch) * reference_to_joint.matrix();
  Eigen::Map<Mat4f>(result.elements) = whole.cast<float>();
  return result;
}

}  // namespace krok
