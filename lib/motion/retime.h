#pragma once

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

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

}  // namespace krok
