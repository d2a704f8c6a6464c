#pragma once

#include <array>
#include <span>

#include "math/hermite.h"
#include "math/transform.h"

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

// Rotation curves through keys at any times, with continuous angular velocity (C1): Shoemake's
// squad (Quaternion calculus and fast animation, SIGGRAPH 1987 course notes). The inner points of
// each segment are computed from the angular velocities at its ends, so that keys need not be
// evenly spaced. For evenly spaced keys and tension 0 they are the usual
// s_i = q_i exp(-(log(q_i^-1 q_{i+1}) + log(q_i^-1 q_{i-1})) / 4).
// Angular velocities are in the key's local frame: q(t + dt) = q(t) exp(w dt). For rotations about
// one axis the curve is the Hermite cubic of the angle.

// Angular velocities (radians per second) at the keys: (1 - tension) times the sum of the two arcs
// that meet at the key over the sum of their durations, as in tension_velocities(). Arcs take the
// shorter way; for 180 degrees, which have none, either of the two. `times` (seconds, strictly
// increasing), `rotations` (unit, either sign) and `velocities` have the same length.
void squad_velocities(std::span<const double> times, std::span<const Quat> rotations,
                      double tension, Ends ends, std::span<Vec3> velocities);

// From q0 (t = 0) to q1 (t = 1) in `span` seconds, with angular velocities w0 and w1 at its ends.
// The sign of q1 does not matter; t = 0 and t = 1 give the keys, up to sign.
Quat squad(const Quat& q0, const Vec3& w0, const Quat& q1, const Vec3& w1, double span, double t);

enum class Axis : unsigned char { x = 0, y = 1, z = 2 };

// An order of three different axes as in a BVH channel list: (z, x, y) means R = Rz * Rx * Ry, so
// the last rotation is applied to a vector first.
using EulerOrder = std::array<Axis, 3>;

// The rotation by `angle` radians about a coordinate axis. Exact for angle 0.
Quat axis_rotation(Axis axis, double angle);

// R = R(axes[0], angles[0]) * R(axes[1], angles[1]) * ...; radians. Any number of axes, repeats
// allowed, as in unusual channel lists. Both spans have the same length.
Quat from_axis_rotations(std::span<const Axis> axes, std::span<const double> angles);

// Angles (radians, in the order of `order`) with from_axis_rotations(order, angles) = q. The middle
// angle is in [-pi/2, pi/2], the others in [-pi, pi]. At gimbal lock (middle angle within 1e-7 of
// +-pi/2) the last angle is `last_at_lock` and the first contains the remaining rotation.
Vec3 to_euler(const Quat& q, const EulerOrder& order, double last_at_lock = 0.0);

// Of the equivalent angle triples (other branch of the middle angle, full turns added), the one
// closest to `previous`, so that angle curves over time have no jumps.
Vec3 closest_euler(const Vec3& angles, const Vec3& previous);

}  // namespace krok
