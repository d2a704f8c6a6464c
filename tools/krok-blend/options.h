#pragma once

#include <string>
#include <vector>

#include "blend/blend_clips.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"
#include "tools/shared/keys_choice.h"

namespace krok::cli::blend {

enum class WarpChoice : unsigned char { pchip, linear, dtw };

struct Options {
  std::vector<std::string> inputs;  // PATH:WEIGHT
  KeysChoice keys = KeysChoice::automatic;
  WarpChoice warp = WarpChoice::pchip;
  krok::blend::Align align = krok::blend::Align::root;
  double rate = 0;  // 0: the first motion's
  bool modifier = false;
  std::string map;
  std::string save_warp;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::blend
