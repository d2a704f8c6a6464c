#include <cassert>

#include "skin/binding_internal.h"

namespace krok {

namespace {

using skin_detail::Posed;

float real_dot(const DualQuaternion& a, const DualQuaternion& b) {
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += a.components[i] * b.components[i];
  return sum;
}

// Hemisphere test: negates each pair's quaternion if it opposes that of the first joint.
void fill_pairs(Posed& pose) {
  for (std::size_t i = 0; i < pose.pair_motions.size(); ++i) {
    const skin_detail::Pair pair = pose.binding->pairs[i];
    DualQuaternion& motion = pose.pair_motions[i];
    motion = pose.motions[pair.joint];
    if (real_dot(pose.motions[pair.first], motion) < 0) {
      for (float& component : motion.components) component = -component;
    }
  }
}

}  // namespace

SkinPose::SkinPose(const SkinBinding& binding) : data_(std::make_unique<Posed>()) {
  data_->binding = &binding.data();
  data_->palette.resize(binding.joint_count());
  if (binding.method() == SkinMethod::dual_quaternion) {
    data_->motions.resize(binding.joint_count());
    data_->pair_motions.resize(binding.data().pairs.size());
  }
  set(binding.data().joint_to_world);
}
SkinPose::SkinPose(SkinPose&&) noexcept = default;
SkinPose& SkinPose::operator=(SkinPose&&) noexcept = default;
SkinPose::~SkinPose() = default;

void SkinPose::set(std::span<const Transform> joint_to_world) {
  const auto& reference_to_joint = data_->binding->reference_to_joint;
  assert(joint_to_world.size() == reference_to_joint.size());
  data_->is_rigid = true;
  if (data_->motions.empty()) {
    make_palette(reference_to_joint, joint_to_world, data_->palette);
    return;
  }
  for (std::size_t j = 0; j < joint_to_world.size(); ++j) {
    data_->motions[j] = dual_quaternion(joint_to_world[j] * reference_to_joint[j]);
  }
  fill_pairs(*data_);
}

template <typename MatrixOf>
void SkinPose::set_matrices(const MatrixOf& matrix_of) {
  data_->is_rigid = true;
  for (std::size_t j = 0; j < data_->palette.size(); ++j) {
    const SkinMatrix matrix = matrix_of(j);
    data_->is_rigid = data_->is_rigid && is_rigid(matrix);
    if (data_->motions.empty()) {
      data_->palette[j] = matrix;
      continue;
    }
    const auto parts = split(matrix, data_->binding->joint_to_world[j].position);
    data_->motions[j] = parts.motion;
    data_->palette[j] = parts.deformation;
  }
  if (!data_->motions.empty()) fill_pairs(*data_);
}

void SkinPose::set_palette(std::span<const SkinMatrix> palette) {
  assert(palette.size() == data_->palette.size());
  set_matrices([&](std::size_t j) { return palette[j]; });
}

void SkinPose::set(std::span<const Transform> joint_to_world, std::span<const Stretch> stretches) {
  if (stretches.empty()) {
    set(joint_to_world);
    return;
  }
  const auto& reference_to_joint = data_->binding->reference_to_joint;
  assert(joint_to_world.size() == reference_to_joint.size());
  assert(stretches.size() == joint_to_world.size());
  set_matrices([&](std::size_t j) {
    return skin_matrix(reference_to_joint[j], joint_to_world[j], stretches[j]);
  });
}

}  // namespace krok
