#pragma once

#include "tools/krok-view/options.h"

namespace krok::cli::view {

// Reads the files and writes one viewer page.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::view
