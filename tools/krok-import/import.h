#pragma once

#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// Reads the capture, writes the motion and, if asked for, the model; both appear or neither.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::import
