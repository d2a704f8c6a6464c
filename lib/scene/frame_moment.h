#pragma once

#include "core/result.h"

namespace krok {

// A place between two frames of something that is evenly spaced in time: `fraction` of the way, in
// [0, 1), from frame `before` to the next; 0 is the frame itself.
struct FrameMoment {
  int before = 0;
  double fraction = 0;
};

// Where `time` (seconds) falls among `frames` frames of which frame i is at i / rate, clamped to
// them. Times that are a frame's own up to rounding (1e-9 of a frame) give that frame. A time that
// is not a number is the beginning. Needs one frame or more.
FrameMoment frame_moment(double time, double rate, int frames);

// The number of frames at i / rate that lie within `duration` seconds (a remainder under a
// thousandth of a frame counts as within). An Error (code clip-rate) unless the rate is positive
// and finite, or (code clip-too-long) if they would have more than 100 million transforms of
// `joints` joints.
Result<int> frames_within(double duration, double rate, int joints);

}  // namespace krok
