#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-keys/options.h"

namespace krok::cli::keys {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::keys
