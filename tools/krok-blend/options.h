#pragma once

#include <string>
#include <vector>

#include "blend/blend_clips.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"
#include "tools/krok-blend/weighted_input.h"
#include "tools/shared/keys_choice.h"

namespace krok::cli::blend {

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
