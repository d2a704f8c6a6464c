#pragma once

#include <vector>

#include "skin/skin.h"
#include "skin/skin_job_internal.h"

// The data of SkinBinding and SkinPose.

namespace krok::skin_detail {

struct Pair {
  std::uint16_t first, joint;
};

struct Binding {
  SkinMethod method = SkinMethod::linear;
  std::size_t vertex_count = 0;
  std::vector<Transform> joint_to_world;      // in the reference pose
  std::vector<Transform> reference_to_joint;  // inverses of joint_to_world
  std::vector<Block> blocks;
  std::vector<std::uint16_t> joints;
  std::vector<std::uint32_t> pair_indices;  // dual quaternions only
  std::vector<float> weights;
  std::vector<Pair> pairs;

  Influences influences() const;
};

struct Posed {
  const Binding* binding = nullptr;
  bool is_rigid = true;
  std::vector<SkinMatrix> palette;           // [joints]; for dual quaternions the deformations
  std::vector<DualQuaternion> motions;       // [joints]; dual quaternions only
  std::vector<DualQuaternion> pair_motions;  // [pairs]
};

}  // namespace krok::skin_detail
