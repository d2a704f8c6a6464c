#pragma once

#include <optional>
#include <string>

#include "blend/time_map.h"
#include "core/result.h"
#include "tools/cli/tool.h"

namespace krok::cli::blend {

// "walks/slow.anim:0.3", "slow.anim:@weights.csv", or "slow.anim" for an equal share.
struct WeightedInput {
  std::string path;
  std::optional<double> weight;
  bool is_equal_share() const { return !weight && curve.empty(); }
  std::string curve;  // path of a weight curve; empty if the weight is a number or an equal share
};

// Code: usage for an invalid weight.
Result<WeightedInput> parse_weighted_input(const std::string& word);

// Reads a table with the columns "generic", rising, and "weight". Codes, with line and column:
// those of csv::Table; weight-curve for missing values or times that do not rise.
Result<krok::blend::WeightCurve> read_weight_curve(const std::string& path, ToolContext& context);

}  // namespace krok::cli::blend
