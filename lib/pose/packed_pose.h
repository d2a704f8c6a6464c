#pragma once

#include <span>
#include <vector>

#include "scene/clip.h"

// Poses in the layout of the SIMD kernels in this folder: positions and rotations relative to the
// parent, as floats, sixteen joints side by side.

namespace krok {

// joint_to_parent of sixteen joints: x, y, z of the positions (metres) and x, y, z, w of the
// rotations (unit), one row each. Lanes beyond the last joint hold the identity.
struct alignas(64) PoseBlock {
  static constexpr int kLanes = 16;
  float position[3][kLanes];
  float rotation[4][kLanes];
};

// The number of blocks of a pose. Everywhere in this folder a pose is a span of that many.
constexpr int pose_blocks(int joints) {
  return (joints + PoseBlock::kLanes - 1) / PoseBlock::kLanes;
}

// Packs joint_to_parent; `pose` has pose_blocks(joints) blocks. Rotations are normalised (identity
// if invalid); signs are kept.
void pack_pose(std::span<const Transform> joint_to_parent, std::span<PoseBlock> pose);

// Unpacks the first joint_to_parent.size() joints of a pose; rotations are normalised in double
// precision.
void unpack_pose(std::span<const PoseBlock> pose, std::span<Transform> joint_to_parent);

// The skeleton's reference pose, packed: the hemisphere reference of blend_poses().
std::vector<PoseBlock> packed_reference(const Skeleton& skeleton);

// A clip for playback and blending. Successive rotations of a joint are in the same hemisphere, so
// that interpolation between two frames takes the shorter arc.
struct PackedClip {
  int joints = 0;
  int frames = 0;
  double rate = 30.0;             // frames per second, > 0
  std::vector<PoseBlock> blocks;  // [frames x pose_blocks(joints)]

  int blocks_per_pose() const { return pose_blocks(joints); }
  // Seconds from the first frame to the last; 0 for fewer than two.
  double duration() const { return frames < 2 ? 0.0 : (frames - 1) / rate; }
  std::span<const PoseBlock> frame(int index) const;
};

// Pack once, sample often. A clip without frames gives one frame, the reference pose.
PackedClip pack_clip(const Clip& clip);

// Samples packed clips. Positions are interpolated linearly, rotations by normalised linear
// interpolation (nlerp): on the arc of slerp, and for frames 30 degrees apart at most 0.04 degrees
// ahead or behind (1 at 90 degrees; the error grows with the cube). Times are seconds, clamped to
// the clip as in frame_moment(); use wrap_time() to loop. Exact at frame times. Nothing is
// allocated. AVX2, AVX-512 and the scalar reference give the same bits.

// The pose at `time`; `pose` has clip.blocks_per_pose() blocks.
void sample_pose(const PackedClip& clip, double time, std::span<PoseBlock> pose);

// The scalar reference of sample_pose().
void sample_pose_reference(const PackedClip& clip, double time, std::span<PoseBlock> pose);

}  // namespace krok
