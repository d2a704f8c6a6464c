#pragma once

#include <span>
#include <string_view>

#include "tools/cli/tool.h"

// The table of commands: a row for each verb. `krok VERB`, its help, completion in shells and the
// tests take names, summaries and options from it.

namespace krok::cli {

struct Command {
  std::string_view verb;  // "import" of krok-import
  ToolSpec (*make_spec)();
  // krok-VERB is a program of its own, as it loads libraries that would slow the start of all
  // others; here it can only be described.
  bool own_program = false;
};

// In the order of a project: files, motions, operations, steps, pictures.
std::span<const Command> commands();

// Null if there is none.
const Command* find_command(std::string_view verb);

}  // namespace krok::cli
