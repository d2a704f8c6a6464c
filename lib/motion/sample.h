#pragma once

#include <span>

#include "scene/clip.h"

namespace krok {

// The pose at `time` seconds, clamped to the clip's range: joint_to_world, shape [joints].
// Between frames each joint is interpolated relative to its parent, the position linearly, the
// orientation by slerp along the shorter arc, so that bones keep their length. At a frame's own
// time the frame comes back as Clip::get_pose gives it. A time that is not a number is the
// beginning. A clip without frames gives the reference pose. `scratch` is working space of at least
// [3 x joints] elements, so that nothing is allocated.
void sample(const Clip& clip, double time, std::span<Transform> joint_to_world,
            std::span<Transform> scratch);

// The clip at another rate: frame i of the result is the sample at i / rate, bit for bit the
// original's frame where it falls on one. The last frame is the
// last that lies within the original's duration (a remainder under a thousandth of a frame counts
// as within). An Error (code clip-rate) unless the rate is positive and finite, or if the result
// would have more than 100 million joint transforms (code clip-too-long).
Result<Clip> resample(const Clip& clip, double rate);

}  // namespace krok
