#pragma once

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

// What becomes of the last moment of a motion when its frames fall between the old ones.
enum class LastFrame {
  within,  // times are exact; the last frame is the last that lies within (as resample() does)
  kept     // the motion is stretched by less than half a frame in all, or to two frames where it
           // would have less, so that its last frame stays the last: what a loop needs
};

// The clip at another rate, and `speed` times as fast; the rate may be the same. Frame i is the
// sample at i * speed / rate of the original, as sample() takes it. Codes: motion-speed unless the
// speed is positive and finite, and those of resample().
Result<Clip> retime(const Clip& clip, double rate, double speed, LastFrame last);

}  // namespace krok
