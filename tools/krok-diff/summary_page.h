#pragma once

#include <string>

#include "core/result.h"
#include "tools/krok-diff/folders.h"
#include "tools/krok-diff/options.h"

// A page about a comparison: the files that are not the same, the worst first.

namespace krok::cli::diff {

// Writes the page: HTML with pictures and charts inside, which needs no other file, or, by
// extension, Markdown, or a test case for each file (JUnit) for CI servers. Links to the files
// compared are relative to the page.
Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
