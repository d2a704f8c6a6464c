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

// Weighted pose blending. Positions are summed with their weights, and rotations as quaternions,
// each in the hemisphere of the joint's rotation in the reference pose; the sum is normalised. For
// weights that sum to 1 this is the quaternion mean of Markley and others (Averaging Quaternions,
// J. Guidance, Control, and Dynamics 30, 2007) up to the third power of the spread. Weights may be
// negative or have another sum, which scales the positions. A vanishing sum of rotations (shorter
// than 1e-6) becomes the reference's rotation.
//
// Agreement: the functions return the smallest length of a joint's quaternion sum before
// normalisation. With weights >= 0 that sum to 1 it is 1 if all rotations agree, cos(angle / 4) for
// two rotations `angle` apart at equal weights (0.92 at 90 degrees, 0.71 at 180), and near 0 if the
// mean is meaningless.
//
// Nothing is allocated. AVX2, AVX-512 and the scalar reference give the same bits.

// A clip with its sample time (seconds, as in sample_pose()) and its weight.
struct BlendTerm {
  const PackedClip* clip = nullptr;
  double time = 0;
  float weight = 0;
};

// Samples and blends all terms in one pass. All clips have as many joints as `reference` and
// `pose`. Without terms: the reference's rotations and zero positions. Returns the agreement.
// `pose` must not overlap anything else.
float blend_poses(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                  std::span<PoseBlock> pose);

// The scalar reference of blend_poses().
float blend_poses_reference(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                            std::span<PoseBlock> pose);

// The same in steps, for poses from other sources: clear_sum(), add_to_sum() for each pose,
// finish_sum().
void clear_sum(std::span<PoseBlock> sum);
void add_to_sum(std::span<const PoseBlock> pose, float weight, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum);
// Normalises the rotations; returns the agreement.
float finish_sum(std::span<const PoseBlock> reference, std::span<PoseBlock> sum);

// Computes joint_to_world from joint_to_parent for many poses of a skeleton, sixteen at a time:
// each SIMD lane is a pose, so the hierarchy is walked once for all of them. A single pose takes as
// long as sixteen. Nothing is allocated. AVX2, AVX-512 and the scalar reference give the same bits.

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
