#pragma once

#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"

namespace krok::ragdoll {

// Whether the first pose of a motion that stands on y = 0 is on its feet: the hips are higher than
// those of people who kneel, sit or crawl.
bool begins_standing(const Clip& motion, const RoleMap& roles);

// The motion with standing up from a crouch before it, in which fingertips are on the ground and
// the hips low over the feet; these are where the first pose has them. The motion begins slowly. As
// given where the skeleton lacks a leg or an arm. Codes: those of ik::apply_goals().
Result<Clip> begun_in_crouch(const Clip& motion, const RoleMap& roles);

}  // namespace krok::ragdoll
