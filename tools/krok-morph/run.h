#pragma once

#include "tools/krok-morph/options.h"

namespace krok::cli::morph {

// Runs the chosen action; see actions.h.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::morph
