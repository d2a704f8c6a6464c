#pragma once

#include <span>

#include "scene/skeleton.h"

namespace krok::body {

// Rotates a joint and its descendants about the joint's position, in world space.
void turn_joint(const Skeleton& skeleton, int joint, const Quat& rotation,
                std::span<Transform> joint_to_world);

// The angle between two vectors, radians in [0, pi]; 0 if either is zero.
double turn_angle(const Vec3& a, const Vec3& b);

}  // namespace krok::body
