#pragma once

#include <vector>

#include "plant/plant_feet.h"

// Other clean-ups of foot skate to measure beside plant_feet(), given the same stays
// and places.

namespace krok::bench {

// In each frame of a stay of heel or ball the ankle is put where the point comes to its place, by
// two-bone inverse kinematics; nothing else is done.
Clip plain_locking(const Clip& clip, const RoleMap& roles, const std::vector<FixedStay>& stays);

// Kovar, Schreiner and Gleicher, "Footskate Cleanup for Motion Capture Editing", Symposium on
// Computer Animation 2002, after the paper's description: ankles
// placed for heel, ball or both; their changes blended into frames without constraint within a
// window; the root projected to where both ankles are within reach, its changes blended alike; legs
// solved in closed form with knees damped near full extension, and stretched by what is missing.
Clip kovar_2002(const Clip& clip, const RoleMap& roles, const std::vector<FixedStay>& stays);

}  // namespace krok::bench
