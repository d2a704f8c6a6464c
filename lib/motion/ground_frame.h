#pragma once

#include <cstdint>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Position and heading of a character on the ground, and the joints they are taken from.

namespace krok {

// A point on the ground (y = 0) and a heading in radians about +Y: 0 faces +Z, a quarter turn faces
// +X, the left of a character facing +Z.
struct GroundFrame {
  double x = 0, z = 0;
  double heading = 0;

  // From the character's frame (origin on the ground below it, facing +Z) to the world.
  Transform to_world() const;
};

// The joint whose position and heading count as the character's: the hips if roles are known,
// otherwise the root.
int carrying_joint(const RoleMap& roles);

// The ground frame for a carrying joint at `carrier_to_world`. The heading is the twist about +Y of
// its rotation from the reference pose, which faces +Z; leaning does not affect it.
GroundFrame ground_frame(const Skeleton& skeleton, int carrier, const Transform& carrier_to_world);

// The ground frame at one frame of a clip.
GroundFrame ground_frame(const Clip& clip, int carrier, int frame);

// Wraps an angle to [-pi, pi].
double wrapped(double angle);

// Feet, toes and the end sites below them; all joints if none has such a role. Ascending.
std::vector<int> foot_joints(const Skeleton& skeleton, const RoleMap& roles);

// 1 for `joint` and its descendants, otherwise 0. Shape [joints].
std::vector<std::uint8_t> subtree(const Skeleton& skeleton, int joint);

}  // namespace krok
