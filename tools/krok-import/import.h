#pragma once

#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// Whether the options have values that fit some file or other.
Status check(const Options& options);

// Reads the capture, writes the motion and, if asked for, the model; both appear or neither.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::import
