#pragma once

#include <string>
#include <vector>

#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-fit/fit_library.h"

namespace krok::cli::fit {

// The report for --json.
Json report_json(const LibraryInput& input, const FittedLibrary& fitted);

// The same with the data needed to resume, see saved_fit.h; formats/steps stores it in the file.
Json saved_json(const LibraryInput& input, const FittedLibrary& fitted);

// Logs a short summary: the examples, errors before and after, why refinement stopped.
void say_report(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context);

}  // namespace krok::cli::fit
