#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/body_choice.h"
#include "tools/common/tool.h"

namespace krok::view {

enum class Layout : unsigned char { automatic, apart, together, list };
enum class KeysChoice : unsigned char { automatic, none, find };

struct Options {
  std::vector<std::string> inputs;
  Layout layout = Layout::automatic;
  BodyChoice body = BodyChoice::automatic;
  KeysChoice keys = KeysChoice::automatic;
  bool difference = false;
  std::string title;
};

void declare(CommandOptions& command, Options& options);

// Reads the files and writes one viewer page.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::view
