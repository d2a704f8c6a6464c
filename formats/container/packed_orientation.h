#pragma once

#include <array>

#include "math/types.h"

// Orientations as Krok's binary formats store them. Three floats x, y, z are enough for a unit
// quaternion, because q and -q are the same rotation: the one with w <= 0 is stored, and w comes
// back as -sqrt(1 - x*x - y*y - z*z), or 0 where rounding has made that negative.

namespace krok {

// xyz: three floats, w rebuilt. xyzw: all four floats as they are.
enum class OrientationEncoding : unsigned char { xyz, xyzw };

// Floats an orientation takes: 3 or 4.
constexpr int float_count(OrientationEncoding encoding) {
  return encoding == OrientationEncoding::xyz ? 3 : 4;
}

// The three floats for `q`, a quaternion of either sign and of length 1 within rounding.
//
// Near w = 0 the rebuilt w is far more sensitive to the rounding of x, y and z than they are
// themselves (dw = (x dx + y dy + z dz) / w), and rounding each to the nearest float turns the
// rotation by up to 6e-4 rad. So the floats around x, y and z are searched for a triple from which
// the whole quaternion comes back best. What unpack_orientation gave, rounded to floats or not,
// packs to the same three floats again. q = 0 gives zeros, which stand for the identity.
std::array<float, 3> pack_orientation(const Quat& q);

// The quaternion that three stored floats stand for, rebuilt in doubles; w is never positive. Of
// length 1 unless x*x + y*y + z*z > 1.
Quat unpack_orientation(const std::array<float, 3>& xyz);

}  // namespace krok
