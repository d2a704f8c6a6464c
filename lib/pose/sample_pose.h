#pragma once

#include <span>

#include "pose/packed_pose.h"

// Sampling packed clips. Positions go linearly between frames, rotations by normalised linear
// interpolation: on the arc of slerp, and for frames that differ by 30 degrees at most 0.04 degrees
// before or behind it (1 at 90 degrees; the error goes with the cube). Times are seconds, clamped
// to the clip as frame_moment() does it; wrap_time() makes others of them. At a frame's own time
// exactly the frame. Nothing is allocated. The same bits on AVX2, AVX-512 and for the reference.

namespace krok {

// The pose at `time`; `pose` has clip.blocks_per_pose() blocks.
void sample_pose(const PackedClip& clip, double time, std::span<PoseBlock> pose);

// The poses at many times in any order, one after the other: [times x clip.blocks_per_pose()].
void sample_poses(const PackedClip& clip, std::span<const double> times,
                  std::span<PoseBlock> poses);

// The scalar reference of sample_pose().
void sample_pose_reference(const PackedClip& clip, double time, std::span<PoseBlock> pose);

}  // namespace krok
