#pragma once

#include "core/result.h"
#include "tools/common/batch/batch_list.h"
#include "tools/common/command_line.h"

namespace krok {

// Whether the files of a batch can be done side by side: no two results (outputs, and outputs that
// options name) share a file, and none replaces an input, the manifest or the report. What is wrong
// is added to `errors` (code usage). Fills in list.read_files.
void check_batch(const CommandLine& line, BatchList& list, Diagnostics& errors);

}  // namespace krok
