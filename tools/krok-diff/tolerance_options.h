#pragma once

#include "compare/matching.h"
#include "tools/cli/command_options.h"

// Options for matching and tolerances.

namespace krok::cli::diff {

struct Options;

// Codes of the values: usage, those of quantities, quantity-range.
void declare_tolerances(CommandOptions& command, Options& options);

// The value of --match.
const char* word_of(compare::Matching matching);

}  // namespace krok::cli::diff
