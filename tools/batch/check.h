#pragma once

#include "core/result.h"
#include "tools/batch/list.h"
#include "tools/cli/command_line.h"

namespace krok::cli::batch {

// Checks that no two outputs of a batch (including those that options name) are the same file, and
// that none overwrites an input, the manifest or the report. Adds problems to `errors` (code
// usage). Fills in list.read_files.
void check_batch(const CommandLine& line, BatchList& list, Diagnostics& errors);

}  // namespace krok::cli::batch
