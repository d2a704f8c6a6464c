#pragma once

#include <span>
#include <vector>

#include "scene/clip.h"

// Poses as the SIMD kernels of this folder take them: positions and rotations relative to the
// parent, as floats, sixteen joints side by side.

namespace krok {

// joint_to_parent of sixteen joints: x, y, z of the positions (metres) and x, y, z, w of the
// rotations (unit), each as one row. Joints beyond the skeleton's last have the identity.
struct alignas(64) PoseBlock {
  static constexpr int kLanes = 16;
  float position[3][kLanes];
  float rotation[4][kLanes];
};

// The blocks of a pose of so many joints. Everywhere in this folder a pose is a span of as many.
constexpr int pose_blocks(int joints) {
  return (joints + PoseBlock::kLanes - 1) / PoseBlock::kLanes;
}

// Packs joint_to_parent; `pose` has pose_blocks() of the joints. Rotations are normalised (the
// identity for what is none); signs stay.
void pack_pose(std::span<const Transform> joint_to_parent, std::span<PoseBlock> pose);

// The first joint_to_parent.size() joints of a pose; rotations normalised in doubles.
void unpack_pose(std::span<const PoseBlock> pose, std::span<Transform> joint_to_parent);

// The skeleton's reference pose, packed: what the sign rule of blend_poses() goes by.
std::vector<PoseBlock> packed_reference(const Skeleton& skeleton);

// A clip for playing and blending. Successive rotations of a joint lie in one hemisphere, so that
// between two frames the straight way is the shorter one.
struct PackedClip {
  int joints = 0;
  int frames = 0;
  double rate = 30.0;             // frames a second, > 0
  std::vector<PoseBlock> blocks;  // [frames x pose_blocks(joints)]

  int blocks_per_pose() const { return pose_blocks(joints); }
  // Seconds from the first frame to the last; 0 for fewer than two.
  double duration() const { return frames < 2 ? 0.0 : (frames - 1) / rate; }
  std::span<const PoseBlock> frame(int index) const;
};

// Made once, then sampled often. A clip without frames gives one frame, the reference pose.
PackedClip pack_clip(const Clip& clip);

}  // namespace krok
