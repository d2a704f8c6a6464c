#pragma once

#include <span>

#include "pose/packed_pose.h"

// Computes joint_to_world from joint_to_parent for many poses of a skeleton, sixteen at a time:
// each SIMD lane is a pose, so the hierarchy is walked once for all of them. A single pose takes as
// long as sixteen. Nothing is allocated. AVX2, AVX-512 and the scalar reference give the same bits.

namespace krok {

// joint_to_world as a matrix: rows of [R | t].
struct alignas(16) JointMatrix {
  float rows[3][4];
};

// Common input. `parents`: [joints], parents before children, -1 for the root. `poses`:
// [count x pose_blocks(joints)], pose by pose. `scratch`: model_scratch(joints) blocks of working
// memory.
struct LocalPoses {
  std::span<const int> parents;
  std::span<const PoseBlock> poses;
  std::span<PoseBlock> scratch;
};
constexpr int model_scratch(int joints) {
  return pose_blocks(joints) * PoseBlock::kLanes;
}

// Positions and orientations as in a Clip, [count x joints] each; for all frames of a clip these
// can be `clip.positions` and `clip.orientations`. Orientations are products of unit quaternions,
// of unit length up to float rounding.
void local_to_model(const LocalPoses& local, std::span<Vec3f> positions,
                    std::span<Quatf> orientations);

// Same as matrices, [count x joints].
void local_to_model(const LocalPoses& local, std::span<JointMatrix> joint_to_world);

// The scalar references.
void local_to_model_reference(const LocalPoses& local, std::span<Vec3f> positions,
                              std::span<Quatf> orientations);
void local_to_model_reference(const LocalPoses& local, std::span<JointMatrix> joint_to_world);

}  // namespace krok
