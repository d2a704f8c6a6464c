#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/steps/steps.h"
#include "tools/cli/tool.h"

// A library's parameters by the names in its description, and requested values.

namespace krok::cli::synth {

struct NamedParameter {
  std::string name;                      // "length"
  std::string measures;                  // "step.length"
  std::string_view unit;                 // "m", "rad" or "s"
  double least = 0, most = 0, mean = 0;  // over the examples
};

std::vector<NamedParameter> parameters_of(const steps::StepsFile& file);

// Parses NAME=VALUE words; quantities with or without a unit. Parameters that are not among them
// have the examples' mean, which is printed. Code: usage, listing the library's parameters, if a
// name is unknown or repeated.
Result<std::vector<double>> parse_settings(const std::vector<std::string>& words,
                                           const std::vector<NamedParameter>& parameters,
                                           ToolContext& context);

// Reads a table with a column per parameter; headers may name a unit, as in "length [cm]". Codes:
// those of csv::Table, with line and column; synth-table for a missing value or an unsuitable unit.
Result<std::vector<std::vector<double>>> read_points(const std::string& path,
                                                     const std::vector<NamedParameter>& parameters,
                                                     ToolContext& context);

}  // namespace krok::cli::synth
