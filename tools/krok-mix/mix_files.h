#pragma once

#include <string>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/common/keys_choice.h"
#include "tools/common/tool.h"

namespace krok::mix_tool {

struct Options {
  std::string input;
  KeysChoice keys = KeysChoice::automatic;
  std::string map;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

void declare(CommandOptions& command, Options& options);
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::mix_tool
