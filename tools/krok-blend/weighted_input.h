#pragma once

#include <optional>
#include <string>

#include "blend/time_map.h"
#include "core/result.h"
#include "tools/common/tool.h"

namespace krok::blend_tool {

// "walks/slow.anim:0.3" or "slow.anim:@weights.csv".
struct WeightedInput {
  std::string path;
  std::optional<double> weight;
  std::string curve;  // the table's path where the weight is no number
};

// Code usage for a word without a weight, or with one that is no number.
Result<WeightedInput> parse_weighted_input(const std::string& word);

// A table of two columns, "generic", rising, and "weight". Codes, by line and column: those of
// csv::Table, and weight-curve for times that do not rise and gaps.
Result<blend::WeightCurve> read_weight_curve(const std::string& path, ToolContext& context);

}  // namespace krok::blend_tool
