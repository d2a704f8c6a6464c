#pragma once

#include <span>
#include <vector>

#include "math/types.h"

// Orientations of cameras, camera_to_world: a camera looks along its own -Z with +Y up. The world's
// up is +Y.

namespace krok {

// The orientation of a camera at `eye` that looks at `target`, with up in the picture as near to
// the world's up as can be. Where it looks straight up or down (within 0.1 degrees) the world's up
// tells nothing: then the camera is `before`, its orientation a moment ago, turned the shortest way
// to look at the target. Where target and eye are one point, or not finite, it is `before`.
Quat look_at(const Vec3& eye, const Vec3& target, const Quat& before);

// The same at every moment, [moments], each with the moment before it. A camera that looks straight
// up or down from the first moment on takes the up of the first moment that has one; if none has,
// the top of the picture is towards -Z looking down and towards +Z looking up.
std::vector<Quat> look_at(std::span<const Vec3> eyes, std::span<const Vec3> targets);

// The orientation of a camera that looks at something from the direction that is turned by
// `azimuth` about +Y (0 is +Z, a quarter turn is +X) and raised by `elevation` (-pi/2 .. pi/2).
// Defined for looking straight up and down too. The camera's place is the target's plus its
// distance times the orientation's +Z.
Quat looking_from(double azimuth, double elevation);

// The same camera tilted to its right by `angle` radians about the direction it looks in: what is
// level leans to the left in the picture.
Quat rolled(const Quat& orientation, double angle);

}  // namespace krok
