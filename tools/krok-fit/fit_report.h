#pragma once

#include <string>
#include <vector>

#include "tools/common/report.h"
#include "tools/common/tool.h"
#include "tools/krok-fit/fit_library.h"

namespace krok::fit_tool {

// All of it as JSON, as --json prints it.
Json report_json(const LibraryInput& input, const FittedLibrary& fitted);

// The same with what is needed to go on, see saved_fit.h; formats/steps keeps it in the file.
Json saved_json(const LibraryInput& input, const FittedLibrary& fitted);

// A few lines for people: the examples, the errors before and after, how it ended.
void say_report(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context);

}  // namespace krok::fit_tool
