#pragma once

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-render/options.h"

namespace krok::cli::film {

// Renders and writes the film. Returns an exit code.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::film
