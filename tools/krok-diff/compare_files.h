#pragma once

#include <string>

#include "compare/measure.h"
#include "core/result.h"
#include "outcome.h"
#include "tools/common/tool.h"

namespace krok::diff {

struct Options {
  std::string first, second;  // paths
  compare::Tolerance tolerance;
};

// Reads both files and compares them. Codes diff-kind (a file of a kind that cannot be compared),
// diff-kinds (two kinds), and those of the readers.
Result<Outcome> compare_files(const Options& options, ToolContext& context);

}  // namespace krok::diff
