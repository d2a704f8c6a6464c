#pragma once

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok {

// Foot skate as a speed, metres per second: in each frame the horizontal speed of the slowest sole
// point of both feet, averaged over the clip. In walking and standing one foot is always down, so
// this is 0 without foot skate, independent of contact detection. Not meaningful for runs and
// jumps, which have flight phases. 0 for fewer than two frames, and if the roles include no foot.
double slide_speed(const Clip& clip, const RoleMap& roles);

}  // namespace krok
