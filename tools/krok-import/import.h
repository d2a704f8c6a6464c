#pragma once

#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// Checks the options for values that are invalid for any file.
Status check(const Options& options);

// Reads the capture and writes the motion and, if requested, the model; both appear or neither.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::import
