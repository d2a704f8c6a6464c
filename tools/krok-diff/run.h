#pragma once

#include "tools/krok-diff/options.h"

namespace krok::cli::diff {

// Compares two files or two folders, prints and reports the differences.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
