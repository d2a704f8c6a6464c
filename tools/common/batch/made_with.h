#pragma once

#include <string>

#include "tools/common/batch/batch_list.h"
#include "tools/common/tool.h"

namespace krok {

// Checksum for the journal of everything except the inputs' bytes that determines an output: tool,
// version, options, names of inputs and outputs. `context` is that of the file before it is
// processed; `fixed_positionals` are the inputs shared by all files.
std::string made_with(const BatchFile& file, const BatchList& list,
                      const std::vector<std::string>& fixed_positionals,
                      const ToolContext& context);

}  // namespace krok
