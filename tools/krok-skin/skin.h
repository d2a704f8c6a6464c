#pragma once

#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-skin/options.h"

namespace krok::skinning {

// Reads what is to be skinned and its motion, skins, and writes what is wanted.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::skinning
