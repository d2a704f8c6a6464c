#pragma once

#include "tools/krok-mix/options.h"

namespace krok::cli::mix {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::mix
