#pragma once

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-skin/options.h"

namespace krok::cli::skin {

// Reads the subject and its motion, skins it, and writes the output.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::skin
