#pragma once

#include "pose/packed_pose.h"
#include "pose/pose_kernels_internal.h"

namespace krok::pose_detail {

// The two frames around a time, clamped to the clip, and the interpolation factor between them.
Between between_frames(const PackedClip& clip, double time, float weight);

}  // namespace krok::pose_detail
