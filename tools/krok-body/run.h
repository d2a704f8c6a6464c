#pragma once

#include "tools/krok-body/options.h"

namespace krok::cli::body {

// Reads a skeleton, generates the body and writes it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::body
