#pragma once

#include <array>
#include <span>

#include "math/types.h"

namespace krok {

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
