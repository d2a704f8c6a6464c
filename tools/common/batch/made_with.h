#pragma once

#include <string>

#include "tools/common/batch/batch_list.h"
#include "tools/common/tool.h"

namespace krok {

// A checksum of all that makes a result of a batch besides the bytes of its inputs, for the
// journal: tool, version and options, the names of inputs and results. `context` is of the file,
// before it is done; `fixed_positionals` are the inputs that all files share.
std::string made_with(const BatchFile& file, const BatchList& list,
                      const std::vector<std::string>& fixed_positionals,
                      const ToolContext& context);

}  // namespace krok
