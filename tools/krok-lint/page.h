#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "tools/krok-lint/reports.h"

namespace krok::cli::lint {

// An HTML page, without other files: a table of all faults, the worst file first, and for the worst
// fault of each file five images of the body around its worst moment, for the first 100 files.
Result<std::string> page_of(LintedFiles files, ToolContext& context);

}  // namespace krok::cli::lint
