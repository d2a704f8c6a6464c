#pragma once

#include <vector>

#include "ragdoll/bodies.h"
#include "ragdoll/get_up.h"
#include "roles/roles.h"
#include "scene/clip.h"

namespace krok::ragdoll {

// Toes have no bodies and follow their feet, so that their tips go into the ground where a foot
// points down. From `first_frame` on they are bent towards the shin until they are over it, by up
// to 80 degrees and by up to 600 degrees a second, so that they begin before they have to; not
// those of a foot that turns over onto its instep, where that helps less and less, nor toes that
// have a body.
void bend_toes(int first_frame, const RoleMap& roles, const std::vector<Body>& bodies,
               const GroundHeight& ground, Clip& clip);

}  // namespace krok::ragdoll
