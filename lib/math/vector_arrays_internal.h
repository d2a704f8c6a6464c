#pragma once

#include "math/vector_arrays.h"

// The plain versions: what the wide ones are held against, and what they leave over.

namespace krok::vector_arrays_detail {

bool all_finite(std::span<const float> numbers);

// Goes on with `bounds`.
void subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors, VectorBounds& bounds);

// Around nothing.
VectorBounds no_bounds();

}  // namespace krok::vector_arrays_detail
