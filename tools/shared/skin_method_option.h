#pragma once

#include <string>

#include "skin/skin.h"
#include "tools/cli/command_options.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli {

// --method, for tools that move meshes by joints.
inline CommandOption add_skin_method(CommandOptions& command, SkinMethod& method,
                                     const std::string& description) {
  return add_choice(command, "--method", method,
                    {{"linear", SkinMethod::linear},
                     {"dual-quaternion", SkinMethod::dual_quaternion},
                     {"rigid", SkinMethod::rigid}},
                    description, "METHOD", "linear");
}

}  // namespace krok::cli
