#pragma once

#include <span>

#include "math/hermite.h"
#include "math/types.h"

// A curve of rotations through keys at times of their own, with continuous angular velocity (C1):
// Shoemake's squad (Quaternion calculus and fast animation, SIGGRAPH 1987 course notes), with the
// inner points of each segment taken from the angular velocities at its ends, so that times need
// not be evenly spaced. For evenly spaced keys and tension 0 the inner points are the usual
// s_i = q_i exp(-(log(q_i^-1 q_{i+1}) + log(q_i^-1 q_{i-1})) / 4). Angular velocities are in the
// key's own frame: q(t + dt) = q(t) exp(w dt). For rotations about one axis the curve is the
// Hermite cubic of the angle.

namespace krok {

// Angular velocities (radians a second) at the keys: (1 - tension) times the mean of the velocities
// of the two arcs that meet at the key, each by the time of the other as tension_velocities() has
// it. Arcs go the shorter way; half a turn, which has no shorter way, goes one of the two. `times`
// (seconds, rising strictly), `rotations` (unit, either sign) and `velocities` have one length.
void squad_velocities(std::span<const double> times, std::span<const Quat> rotations,
                      double tension, Ends ends, std::span<Vec3> velocities);

// From q0 (t = 0) to q1 (t = 1), `span` seconds later, with the angular velocities w0 and w1 at its
// ends. The sign of q1 does not matter; at t = 0 and t = 1 the keys themselves, up to sign.
Quat squad(const Quat& q0, const Vec3& w0, const Quat& q1, const Vec3& w1, double span, double t);

}  // namespace krok
