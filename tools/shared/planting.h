#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/long_take.h"
#include "plant/plant_feet.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"

// --plant and --contacts, for the tools that have them.

namespace krok::cli {

// The contacts that --contacts asks for; none where they are to be found in the motion.
Result<std::optional<std::vector<krok::Contact>>> read_planting_contacts(
    const std::string& contacts, const std::string& motion_path, const FrameSource& motion,
    ToolContext& context);

// plant_feet(), of a motion in place while it travels as it did before.
Result<PlantedFeet> plant(const Clip& clip, const RoleMap& roles,
                          const std::optional<std::vector<krok::Contact>>& contacts);

// The same of a long take, see plant_long_take().
PlantedFrames plant_frames(const FrameSource& motion, const RoleMap& roles,
                           const std::optional<std::vector<krok::Contact>>& contacts,
                           const std::optional<RootMotion>& removed, ToolContext& context);

// For the report: where the contacts are from, drift before and after, lowering of the pelvis, and
// each stay.
Json planting_json(const PlantedFeet& planted, bool contacts_given);

// One line for display.
std::string planting_line(const PlantedFeet& planted);

// --plant of the tools that blend: foot skate clean-up of what they made.

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
