#pragma once

#include <string>
#include <vector>

#include "tools/cli/tool.h"

namespace krok::cli::info {

struct Options {
  std::vector<std::string> files;
  std::string map;  // a role map; empty: none
  bool textconv = false;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Describes each file on standard output and in the report. Continues after a file that cannot be
// read; the exit code is then kExitTrouble.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::info
