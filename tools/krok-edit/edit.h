#pragma once

#include "tools/common/tool.h"
#include "tools/krok-edit/options.h"

namespace krok::edit {

// Reads the motion, does what was asked for, step by step in the order of the help, and writes it.
Result<int> run(const Options& options, ToolContext& context);

// The tool, with options of its own: each call's are independent of the others'.
ToolSpec make_spec();

}  // namespace krok::edit
