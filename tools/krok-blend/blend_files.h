#pragma once

#include <string>
#include <vector>

#include "blend/blend_clips.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/common/keys_choice.h"
#include "tools/common/tool.h"

namespace krok::blend_tool {

enum class WarpChoice : unsigned char { pchip, linear, dtw };

struct Options {
  std::vector<std::string> inputs;  // PATH:WEIGHT
  KeysChoice keys = KeysChoice::automatic;
  WarpChoice warp = WarpChoice::pchip;
  blend::Align align = blend::Align::root;
  double rate = 0;  // 0: the first motion's
  bool modifier = false;
  std::string map;
  std::string save_warp;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

void declare(CommandOptions& command, Options& options);
Status check(const Options& options);
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::blend_tool
