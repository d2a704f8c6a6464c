#pragma once

#include "math/types.h"

// Unit quaternions with defined results for equal, nearly equal, opposite and zero input.
// Quaternions are q = (w, x, y, z) as in Eigen; q and -q are the same rotation.

namespace krok {

// q normalised; the identity if its length is zero, not finite or below 1e-150.
Quat normalized_or_identity(const Quat& q);

// The one of q and -q in the hemisphere of `reference` (dot product >= 0).
Quat in_hemisphere_of(const Quat& reference, const Quat& q);

// The angle of the rotation that takes a to b, in [0, pi] radians; accurate for tiny angles and
// near pi (atan2, not acos), the same for q and -q.
double angle_between(const Quat& a, const Quat& b);

// Spherical linear interpolation along the shorter arc from a (t = 0) to b (t = 1); t is not
// clamped. Falls back to nlerp if a and b are so close (under 1e-6 rad) that dividing by the sine
// is inaccurate. For rotations 180 degrees apart (dot = 0 exactly) the sign of b is kept.
Quat slerp(const Quat& a, const Quat& b, double t);

// Normalised linear interpolation along the shorter arc; identity if the sum is zero.
Quat nlerp(const Quat& a, const Quat& b, double t);

// The rotation vector (axis times angle, length in [0, pi]) of q; zero for the identity.
Vec3 rotation_vector(const Quat& q);

// The inverse of rotation_vector, for vectors of any length.
Quat from_rotation_vector(const Vec3& v);

// The rotation by the smallest angle that takes the direction of `from` to that of `to`. Identity
// if either is zero; for opposite directions 180 degrees about an axis perpendicular to `from`,
// always the same one for the same `from`.
Quat shortest_arc(const Vec3& from, const Vec3& to);

}  // namespace krok
