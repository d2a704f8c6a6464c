#pragma once

#include <string>

#include "tools/batch/list.h"
#include "tools/cli/tool.h"

namespace krok::cli::batch {

// Checksum for the journal of everything except the inputs' bytes that determines an output: tool,
// version, options, names of inputs and outputs. `context` is that of the file before it is
// processed; `fixed_positionals` are the inputs shared by all files.
std::string made_with(const BatchFile& file, const BatchList& list,
                      const std::vector<std::string>& fixed_positionals,
                      const ToolContext& context);

}  // namespace krok::cli::batch
