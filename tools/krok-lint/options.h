#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::lint {

struct Options {
  std::vector<std::string> inputs;
  std::string map;                        // path of a role map, or empty
  std::vector<std::string> only, ignore;  // ids of rules
  bool list_rules = false;
  bool loops = false, treadmill = false, self_intersection = false;
  GroundChoice ground;
  std::string profile, baseline;  // paths, or empty
  // Paths of outputs, or empty; `fix` and `save_pages` are folders.
  std::string table, sarif, junit, html, save_pages, save_baseline, fix;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Looks for faults in each motion; prints and writes them.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::lint
