#pragma once

#include <string>

#include "core/result.h"
#include "tools/krok-diff/options.h"
#include "tools/krok-diff/outcome.h"

namespace krok::cli::diff {

// Compares both files and writes the requested plots and images. Codes diff-kind (a file type that
// cannot be compared), diff-kinds (two different types), and those of the readers.
Result<Outcome> compare_files(const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
