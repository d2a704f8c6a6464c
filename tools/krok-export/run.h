#pragma once

#include "tools/krok-export/options.h"

namespace krok::cli::exporting {

// Reads a motion and writes it in the given format, or in that of the output's extension.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::exporting
