#pragma once

#include "scene/clip.h"

namespace krok {

// Fills the frames between two valid ones (first < next) by interpolating local transforms:
// positions linearly, orientations by slerp. Preserves bone lengths that are equal at both ends.
void fill_frames_between(Clip& clip, int first, int next);

}  // namespace krok
