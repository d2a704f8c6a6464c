#pragma once

#include <string>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::mix {

struct Options {
  std::string input;
  KeysChoice keys = KeysChoice::automatic;
  std::string map;
  bool plant = false;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::mix
