#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/steps/steps.h"
#include "tools/common/tool.h"

// What a library can be asked for, by the names that its description gave, and what is asked.

namespace krok::synth_tool {

struct NamedParameter {
  std::string name;            // "length"
  std::string measures;        // "step.length"
  std::string_view unit;       // "m", "rad" or "s"
  double least = 0, most = 0;  // of the examples
};

std::vector<NamedParameter> parameters_of(const steps::StepsFile& file);

// "length 0.45 to 0.8 m, turn -10 to 30 degrees", for people.
std::string in_words(const std::vector<NamedParameter>& parameters);

// The values of NAME=VALUE words, one for each parameter; quantities with or without a unit. Code
// usage, with what the library takes, for a name that is not known, missing or given twice.
Result<std::vector<double>> parse_settings(const std::vector<std::string>& words,
                                           const std::vector<NamedParameter>& parameters);

// The rows of a table with a column for each parameter; a column's header may name its unit, as in
// "length [cm]". Codes: those of csv::Table, by line and column; synth-table for a gap or a unit
// that does not fit.
Result<std::vector<std::vector<double>>> read_points(const std::string& path,
                                                     const std::vector<NamedParameter>& parameters,
                                                     ToolContext& context);

}  // namespace krok::synth_tool
