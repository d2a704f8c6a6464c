#pragma once

#include "tools/krok-walk/options.h"

namespace krok::cli::walk {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::walk
