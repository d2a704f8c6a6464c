#pragma once

#include <cstdint>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Where a figure stands and where it faces, and the joints that tell it.

namespace krok {

// A point of the ground (y = 0) and a direction on it. The heading is radians about +Y: 0 faces +Z,
// a quarter turn +X, which is to the figure's left.
struct GroundFrame {
  double x = 0, z = 0;
  double heading = 0;

  // From the figure's own frame (origin below it, facing +Z) to the world.
  Transform to_world() const;
};

// The joint whose place and facing count as the figure's: the hips, where roles are known,
// otherwise the root.
int carrying_joint(const RoleMap& roles);

// The place of a figure whose carrying joint stands at `carrier_to_world`. The heading is the turn
// about +Y of its rotation from the reference pose, in which figures face +Z; leaning does not
// matter to it.
GroundFrame ground_frame(const Skeleton& skeleton, int carrier, const Transform& carrier_to_world);

// The place in one frame.
GroundFrame ground_frame(const Clip& clip, int carrier, int frame);

// An angle brought into [-pi, pi].
double wrapped(double angle);

// Feet, toes and the end sites below them; all joints where no role tells of feet. Ascending.
std::vector<int> foot_joints(const Skeleton& skeleton, const RoleMap& roles);

// 1 for a joint and all joints below it, shape [joints].
std::vector<std::uint8_t> subtree(const Skeleton& skeleton, int joint);

}  // namespace krok
