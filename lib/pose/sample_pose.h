#pragma once

#include <span>

#include "pose/packed_pose.h"

// Samples packed clips. Positions are interpolated linearly, rotations by normalised linear
// interpolation (nlerp): on the arc of slerp, and for frames 30 degrees apart at most 0.04 degrees
// ahead or behind (1 at 90 degrees; the error grows with the cube). Times are seconds, clamped to
// the clip as in frame_moment(); use wrap_time() to loop. Exact at frame times. Nothing is
// allocated. AVX2, AVX-512 and the scalar reference give the same bits.

namespace krok {

// The pose at `time`; `pose` has clip.blocks_per_pose() blocks.
void sample_pose(const PackedClip& clip, double time, std::span<PoseBlock> pose);

// The poses at many times in any order, pose by pose: [times x clip.blocks_per_pose()].
void sample_poses(const PackedClip& clip, std::span<const double> times,
                  std::span<PoseBlock> poses);

// The scalar reference of sample_pose().
void sample_pose_reference(const PackedClip& clip, double time, std::span<PoseBlock> pose);

}  // namespace krok
