#pragma once

#include <string>

#include "core/result.h"

namespace krok {

// A time between two evenly spaced frames: `fraction`, in [0, 1), from frame `before` to the next;
// 0 is the frame itself.
struct FrameMoment {
  int before = 0;
  double fraction = 0;
};

// Finds `time` (seconds) among `frames` frames at i / rate, clamped to them. Times within 1e-9
// frames of a frame give that frame. NaN gives the first frame. Needs at least one frame.
FrameMoment frame_moment(double time, double rate, int frames);

// Frames per second that motions have, from one in a quarter of an hour to those of a ballistic
// camera. Beyond them a loop over frames or seconds does not end and a frame time rounds to 0.
constexpr double kMinRate = 0.001, kMaxRate = 100'000;

// Whether a rate is within these limits. NaN is not. `code` is the error's.
Status check_frame_rate(double rate, std::string code);

// The number of frames at i / rate within `duration` seconds (with a tolerance of a thousandth of a
// frame). Codes: clip-rate, see check_frame_rate(); clip-too-long
// if the clip would have more than 100 million transforms of `joints` joints.
Result<int> frames_within(double duration, double rate, int joints);

}  // namespace krok
