#pragma once

#include "tools/common/tool.h"
#include "tools/krok-keys/options.h"

namespace krok::keys_tool {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::keys_tool
