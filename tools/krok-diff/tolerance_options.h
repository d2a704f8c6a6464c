#pragma once

#include <string>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "tools/cli/command_options.h"

// Options for matching and tolerances.

namespace krok::cli::diff {

// As given on the command line; empty: not given.
struct ToleranceArguments {
  compare::Matching matching = compare::Matching::automatic;
  std::string length = "0.01mm";
  std::string angle = "0.01deg";
  std::string ratio = "0.0001";
  std::string times = "0.1ms";
  std::string normals, joints;
  bool materials = false;
};

void declare_tolerances(CommandOptions& command, ToleranceArguments& arguments);

// Codes quantity-number, quantity-unit, quantity-range.
Result<compare::Tolerance> parse_tolerances(const ToleranceArguments& arguments);

// The value of --match.
const char* word_of(compare::Matching matching);

}  // namespace krok::cli::diff
