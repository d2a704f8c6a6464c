#pragma once

#include "math/vector_arrays.h"

// Scalar versions: the reference for the SIMD ones, and used by them for the remainder.

namespace krok::vector_arrays_detail {

bool all_finite(std::span<const float> numbers);

// Extends `bounds`.
void subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors, VectorBounds& bounds);

// Empty bounds.
VectorBounds no_bounds();

}  // namespace krok::vector_arrays_detail
