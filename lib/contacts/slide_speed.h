#pragma once

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok {

// How fast feet slide over the ground, metres a second: in each frame the slowest point of the sole
// of the slower foot, its speed along the ground alone, in the mean over the clip. In walking and
// standing a foot always stands, so that this is 0 where nothing slides, whatever contacts are
// found or not. It tells nothing of runs and jumps, in which both feet fly. 0 for fewer than two
// frames, and where the roles know no foot.
double slide_speed(const Clip& clip, const RoleMap& roles);

}  // namespace krok
