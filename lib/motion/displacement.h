#pragma once

#include <span>

#include "scene/clip.h"

namespace krok {

// How far one of some joints was moved, and where: the first of equal ones.
struct Displacement {
  double distance = 0;  // metres
  int joint = 0;
  int frame = 0;
};

// The largest distance between the places that one of `joints` has in the two clips at the same
// frame. They have the same joints and number of frames.
Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints);

}  // namespace krok
