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

}  // namespace krok
