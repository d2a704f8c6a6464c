#pragma once

#include "plant/plant_feet.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"

// --plant of the tools that blend: foot skate clean-up of what they made.

namespace krok::cli {

// Plants the feet of a motion that was made, where its contacts say that they stand, or where they
// are found if it has none, and moves the contacts' positions with them. Returns largest drifts of
// heels and balls before and after, for a report, in metres. Warning plant-contacts if no foot
// stands anywhere. Codes: the other ones of plant_feet().
struct PlantDrift {
  double before = 0, after = 0;
};
Result<PlantDrift> plant_result(Clip& clip, MotionKeys& keys, const RoleMap& roles,
                                ToolContext& context);

Json to_json(const PlantDrift& drift);

// "feet planted: largest drift 0.2 mm instead of 14 mm".
std::string text_of(const PlantDrift& drift);

}  // namespace krok::cli
