#pragma once

#include <string>

#include "formats/io/open_role_map.h"
#include "tools/cli/command_options.h"

// --map: a role map for joints whose names do not identify them.

namespace krok::cli {

CommandOption add_map_option(
    CommandOptions& command, std::string& path, const std::string& name = "--map",
    const std::string& description = "Role map (JSON) for joints whose names do not identify them");

}  // namespace krok::cli
