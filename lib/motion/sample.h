#pragma once

#include <span>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

// The pose at `time` seconds, clamped to the clip's range: joint_to_world, shape [joints]. Between
// frames each joint is interpolated relative to its parent, positions linearly and orientations by
// slerp along the shorter arc, so bone lengths are kept. At a frame's time the result equals
// Clip::get_pose. NaN counts as time 0. A clip without frames gives the reference pose. `scratch`
// is working memory of at least [3 x joints] elements; nothing is allocated.
void sample(const Clip& clip, double time, std::span<Transform> joint_to_world,
            std::span<Transform> scratch);

// Resamples the clip: frame i of the result is the sample at i / rate, bit-identical to the
// original's frame if it falls on one. The last frame is the last within the original's duration (a
// remainder below 0.001 frames counts as within). Codes: clip-rate unless the rate is positive and
// finite, clip-too-long if the result would exceed 100 million joint transforms.
Result<Clip> resample(const Clip& clip, double rate);
// The same of frames that are produced on demand; reads the source when it is read.
Result<FrameSource> resample(const FrameSource& source, double rate);

}  // namespace krok
