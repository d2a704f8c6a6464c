#pragma once

#include "math/quaternion.h"

namespace krok::test {

// The same rotation by the other quaternion.
inline Quat negated(const Quat& q) {
  return Quat(Vec4(-q.coeffs()));
}

}  // namespace krok::test
