#pragma once

#include <span>

#include "math/types.h"

// Passes over long arrays of vectors, such as the vertices of a mesh, in wide registers. The
// results are the same bits on every machine.

namespace krok {

// True where there are none.
bool all_finite(std::span<const Vec3f> vectors);
bool all_finite(std::span<const Vec4f> vectors);

// The box around vectors, and whether all of them are finite: the box means nothing otherwise.
struct VectorBounds {
  Vec3f least, most;
  bool finite = true;
};

// Takes `base` from `vectors`, one by one, and gives the box around the differences; where there
// are none, it reaches from infinity to minus infinity. `base` has as many.
VectorBounds subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors);

}  // namespace krok
