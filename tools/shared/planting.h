#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/plant_feet.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"

// --plant and --contacts, for the tools that have them.

namespace krok::cli {

// The contacts that --contacts asks for; none where they are to be found in the motion.
Result<std::optional<std::vector<krok::Contact>>> read_planting_contacts(
    const std::string& contacts, const std::string& motion_path, const Clip& clip,
    ToolContext& context);

// plant_feet(), of a motion in place while it travels as it did before.
Result<PlantedFeet> plant(const Clip& clip, const RoleMap& roles,
                          const std::optional<std::vector<krok::Contact>>& contacts);

// For the report: where the contacts are from, drift before and after, lowering of the pelvis, and
// each stay.
Json planting_json(const PlantedFeet& planted, bool contacts_given);

// One line for display.
std::string planting_line(const PlantedFeet& planted);

}  // namespace krok::cli
