#pragma once

#include <span>

#include "scene/clip.h"

namespace krok {

// The largest distance that a joint was moved, and the first joint and frame with it.
struct Displacement {
  double distance = 0;  // metres
  int joint = 0;
  int frame = 0;
};

// The largest distance between the positions of one of `joints` in two clips at the same frame.
// Both clips have the same joints and frame count. The second form looks at the frames [begin,
// end).
Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints);
Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints, int begin, int end);

}  // namespace krok
