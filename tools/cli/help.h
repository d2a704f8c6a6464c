#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/cli/tool.h"

namespace krok::cli {

// Sets up the layout of --help: usage, option groups, examples, exit codes.
void shape_help(CLI::App& app, const ToolSpec& spec);

// The text of --help.
std::string help_text(const CLI::App& app);

}  // namespace krok::cli
