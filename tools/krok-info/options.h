#pragma once

#include <string>
#include <vector>

#include "tools/cli/tool.h"

namespace krok::cli::info {

struct Options {
  std::vector<std::string> files;
  std::string map;  // a role map; empty: none
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::info
