#pragma once

#include "scene/clip.h"

namespace krok {

// Every `step`-th frame of [first, last], the first included, as a clip that begins at time 0 and
// whose rate is divided by `step`. Skeleton and provenance are kept. Needs 0 <= first <= last <
// frame_count() and step >= 1.
Clip cut(const Clip& clip, int first, int last, int step = 1);

}  // namespace krok
