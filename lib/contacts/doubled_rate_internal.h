#pragma once

#include "scene/clip.h"

namespace krok::contacts {

// The clip with a frame between each two, by cubic interpolation of world positions and
// orientations; at least four frames. Feet move by half a metre per frame at 30 frames per second,
// and stop within one: events are found between frames, from speeds that need a higher rate.
Clip doubled_rate(const Clip& clip);

}  // namespace krok::contacts
