#pragma once

#include <vector>

#include "plant/foot_paths_internal.h"
#include "plant/legs_internal.h"

// Legs from where the pelvis and the feet are. Used by plant_feet().

namespace krok::plant {

// Metres by which the pelvis is lowered, >= 0, [frames], so that legs that are nearly straight are
// not stretched further.
std::vector<double> lowering(const Clip& clip, const PlantedBody& body,
                             const std::vector<FootPath>& paths);

// Applies all to the clip. Returns the number of frames in which a leg does not reach its place.
int apply(const PlantedBody& body, const std::vector<FootPath>& paths,
          const std::vector<double>& lowered, Clip& clip);

}  // namespace krok::plant
