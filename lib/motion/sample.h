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

// How the end of a motion is treated if it falls between the new frames.
enum class LastFrame {
  within,  // times are exact; the last frame is the last within the motion (as in resample())
  kept     // the motion is stretched by less than half a frame in total, or to two frames if it
           // would have fewer, so that its last frame stays the last, as a loop needs
};

// The clip at `rate`, played `speed` times as fast; the rate may be unchanged. Frame i is the
// original at time i * speed / rate, as by sample(). Codes: motion-speed unless the speed is
// positive and finite, and those of resample().
Result<Clip> retime(const Clip& clip, double rate, double speed, LastFrame last);
// The same of frames that are produced on demand; reads the source when it is read.
Result<FrameSource> retime(const FrameSource& source, double rate, double speed, LastFrame last);

// The clip retimed likewise (`keep_last`: LastFrame::kept), but between the frames positions
// relative to the parent follow Hermite cubics and rotations squad curves, with velocities for
// `tension` (tension_velocities(), 0 to 1): smooth where retime() bends at each frame, as of
// motions with few frames. Values at the frames themselves are those of retime() within the
// rounding of floats. Codes: motion-speed unless the speed is positive and finite and the tension
// from 0 to 1; clip-rate, clip-too-long as frames_within().
Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last);

// Copies every `step`-th frame of [first, last], starting with `first`, to a clip that starts at
// time 0 with its rate divided by `step`. Keeps skeleton and provenance. Requires 0 <= first <=
// last < frame_count() and step >= 1.
Clip cut(const Clip& clip, int first, int last, int step = 1);

}  // namespace krok
