#pragma once

#include "tools/krok-blend/options.h"

namespace krok::cli::blend {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::blend
