#pragma once

#include <span>

#include "math/transform.h"

// SIMD operations on long arrays of vectors, such as mesh vertices. Results are the same bits on
// every machine.

namespace krok {

// True for an empty span.
bool all_finite(std::span<const Vec3f> vectors);
bool all_finite(std::span<const Vec4f> vectors);

// The bounding box of vectors, and whether all are finite; otherwise the box is undefined.
struct VectorBounds {
  Vec3f least, most;
  bool finite = true;
};

// Subtracts `base` from `vectors`, element by element, and returns the bounding box of the
// differences; for empty spans from infinity to minus infinity. Both have the same size.
VectorBounds subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors);

}  // namespace krok

// Scalar versions: the reference for the SIMD ones, and used by them for the remainder.
namespace krok::vector_arrays_detail {

bool all_finite(std::span<const float> numbers);

// Extends `bounds`.
void subtract(std::span<const Vec3f> base, std::span<Vec3f> vectors, VectorBounds& bounds);

// Empty bounds.
VectorBounds no_bounds();

}  // namespace krok::vector_arrays_detail
