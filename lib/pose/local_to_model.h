#pragma once

#include <span>

#include "pose/packed_pose.h"

// From joint_to_parent to joint_to_world for many poses of a skeleton, sixteen poses at a time:
// each lane of a vector is a pose, so that the chain of joints is walked once for all of them. A
// single pose takes as long as sixteen. Nothing is allocated. The same bits on AVX2, AVX-512 and
// for the reference.

namespace krok {

// joint_to_world as a matrix: rows of [R | t].
struct alignas(16) JointMatrix {
  float rows[3][4];
};

// What all of the following take. `parents`: [joints], before their children, -1 for the root.
// `poses`: [count x pose_blocks(joints)], one pose after the other. `scratch`: working space of
// model_scratch(joints) blocks.
struct LocalPoses {
  std::span<const int> parents;
  std::span<const PoseBlock> poses;
  std::span<PoseBlock> scratch;
};
constexpr int model_scratch(int joints) {
  return pose_blocks(joints) * PoseBlock::kLanes;
}

// Positions and orientations as a Clip has them, [count x joints] each: for all frames of a clip
// `clip.positions` and `clip.orientations` themselves. Orientations are products of unit
// quaternions and unit up to float rounding.
void local_to_model(const LocalPoses& local, std::span<Vec3f> positions,
                    std::span<Quatf> orientations);

// The same as matrices, [count x joints].
void local_to_model(const LocalPoses& local, std::span<JointMatrix> joint_to_world);

// The scalar references.
void local_to_model_reference(const LocalPoses& local, std::span<Vec3f> positions,
                              std::span<Quatf> orientations);
void local_to_model_reference(const LocalPoses& local, std::span<JointMatrix> joint_to_world);

}  // namespace krok
