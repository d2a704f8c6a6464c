#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-edit/options.h"

namespace krok::cli::edit {

// Reads the motion, applies the requested steps in the order of the help, and writes it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::edit
