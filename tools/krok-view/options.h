#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::view {

enum class Layout : unsigned char { automatic, apart, together, list };
enum class KeysChoice : unsigned char { automatic, none, find };

struct Options {
  std::vector<std::string> inputs;
  Layout layout = Layout::automatic;
  BodyChoice body = BodyChoice::automatic;
  KeysChoice keys = KeysChoice::automatic;
  bool difference = false;
  std::string clip;     // an animation of glTF files; empty: best_animation()
  std::string goals;    // a goal file, or empty
  GroundChoice ground;  // empty: none
  std::string prints;   // a file of footprints, or empty
  std::string bodies;   // rigid bodies to show, or empty
  std::string title;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the files and writes one viewer page.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::view
