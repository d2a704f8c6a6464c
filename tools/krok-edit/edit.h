#pragma once

#include "tools/common/tool.h"
#include "tools/krok-edit/options.h"

namespace krok::edit {

// Reads the motion, applies the requested steps in the order of the help, and writes it.
Result<int> run(const Options& options, ToolContext& context);

// The tool; each call has its own, independent options.
ToolSpec make_spec();

}  // namespace krok::edit
