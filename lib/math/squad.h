#pragma once

#include <span>

#include "math/hermite.h"
#include "math/types.h"

// Rotation curves through keys at any times, with continuous angular velocity (C1): Shoemake's
// squad (Quaternion calculus and fast animation, SIGGRAPH 1987 course notes). The inner points of
// each segment are computed from the angular velocities at its ends, so that keys need not be
// evenly spaced. For evenly spaced keys and tension 0 they are the usual
// s_i = q_i exp(-(log(q_i^-1 q_{i+1}) + log(q_i^-1 q_{i-1})) / 4).
// Angular velocities are in the key's local frame: q(t + dt) = q(t) exp(w dt). For rotations about
// one axis the curve is the Hermite cubic of the angle.

namespace krok {

// Angular velocities (radians per second) at the keys: (1 - tension) times the sum of the two arcs
// that meet at the key over the sum of their durations, as in tension_velocities(). Arcs take the
// shorter way; for 180 degrees, which have none, either of the two. `times` (seconds, strictly
// increasing), `rotations` (unit, either sign) and `velocities` have the same length.
void squad_velocities(std::span<const double> times, std::span<const Quat> rotations,
                      double tension, Ends ends, std::span<Vec3> velocities);

// From q0 (t = 0) to q1 (t = 1) in `span` seconds, with angular velocities w0 and w1 at its ends.
// The sign of q1 does not matter; t = 0 and t = 1 give the keys, up to sign.
Quat squad(const Quat& q0, const Vec3& w0, const Quat& q1, const Vec3& w1, double span, double t);

}  // namespace krok
