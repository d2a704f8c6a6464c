#pragma once

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-import/options.h"

namespace krok::cli::import {

// Reads the capture and writes the motion and, if requested, the model; both appear or neither.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::import
