#pragma once

#include "scene/clip.h"

namespace krok {

// Copies every `step`-th frame of [first, last], starting with `first`, to a clip that starts at
// time 0 with its rate divided by `step`. Keeps skeleton and provenance. Requires 0 <= first <=
// last < frame_count() and step >= 1.
Clip cut(const Clip& clip, int first, int last, int step = 1);

}  // namespace krok
