#pragma once

#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-skin/options.h"

namespace krok::skinning {

// Reads the subject and its motion, skins it, and writes the output.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::skinning
