#pragma once

#include <optional>
#include <string>
#include <vector>

#include "blend/blend_clips.h"
#include "blend/time_map.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::blend {

// "walks/slow.anim:0.3", "slow.anim:@weights.csv", or "slow.anim" for an equal share.
struct WeightedInput {
  std::string path;
  std::optional<double> weight;
  bool is_equal_share() const { return !weight && curve.empty(); }
  std::string curve;  // path of a weight curve; empty if the weight is a number or an equal share
};

// Reads a table with the columns "generic", rising, and "weight". Codes, with line and column:
// those of csv::Table; weight-curve for missing values or times that do not rise.
Result<krok::blend::WeightCurve> read_weight_curve(const std::string& path, ToolContext& context);

// Automatic: stance if all motions have contacts, otherwise root.
enum class AlignChoice : unsigned char { automatic, root, stance, none };
enum class WarpChoice : unsigned char { pchip, linear, dtw };

struct Options {
  std::vector<WeightedInput> inputs;
  KeysChoice keys = KeysChoice::automatic;
  WarpChoice warp = WarpChoice::pchip;
  AlignChoice align = AlignChoice::automatic;
  bool plant = false;
  double rate = 0;  // 0: the first motion's
  bool modifier = false;
  std::string map;
  std::string save_warp;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::blend
