#pragma once

#include "scene/clip.h"

namespace krok {

// Fills the frames between two whole ones (first < next) by interpolation relative to the parents:
// positions linearly, orientations by slerp. Bones keep their lengths where both ends have the
// same.
void fill_frames_between(Clip& clip, int first, int next);

}  // namespace krok
