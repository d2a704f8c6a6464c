#pragma once

#include "math/types.h"

namespace krok {

// Metres. No coordinate is farther from the origin: floats there are 64 m apart, and beyond 1e19
// their squares are infinite.
constexpr float kFarthest = 1e9F;

// Whether all coordinates are finite and within that.
template <typename Vector>
bool is_near(const Vector& position) {
  using Scalar = typename Vector::Scalar;
  return (position.array().abs() <= static_cast<Scalar>(kFarthest)).all();
}

}  // namespace krok
