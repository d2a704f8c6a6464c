#pragma once

#include <array>

#include "math/transform.h"

// Orientations as stored in Krok's binary formats. Three floats x, y, z are enough for a unit
// quaternion, because q and -q are the same rotation: the one with w <= 0 is stored, and w is
// rebuilt as -sqrt(1 - x*x - y*y - z*z), or 0 if rounding makes the radicand negative.

namespace krok {

// xyz: three floats, w is rebuilt. xyzw: four floats, any sign.
enum class OrientationEncoding : unsigned char { xyz, xyzw };

// Floats per orientation: 3 or 4.
constexpr int float_count(OrientationEncoding encoding) {
  return encoding == OrientationEncoding::xyz ? 3 : 4;
}

// The three floats for `q`, a unit quaternion (within rounding) of either sign.
//
// Near w = 0 the rebuilt w is very sensitive to rounding of x, y and z (dw = (x dx + y dy + z dz) /
// w): rounding each to the nearest float gives errors of up to 6e-4 rad. Therefore the neighbouring
// floats are searched for the triple that rebuilds the quaternion best. The result of
// unpack_orientation, rounded to floats or not, packs to the same three floats. q = 0 gives zeros,
// the identity.
std::array<float, 3> pack_orientation(const Quat& q);

// The quaternion of three stored floats, rebuilt in double precision, with w <= 0. It has length 1
// unless x*x + y*y + z*z > 1.
Quat unpack_orientation(const std::array<float, 3>& xyz);

}  // namespace krok
