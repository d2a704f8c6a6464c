#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_options.h"

// Completion of krok and its tools in shells, generated from the options that the tools declare.

namespace krok::cli {

struct CompletedVerb {
  std::string name;  // "skin"
  std::string does;
  std::vector<OptionFacts> options;
};

enum class Shell : unsigned char { bash, zsh, fish };

// A script that the shell sources.
std::string completion_script(Shell shell, std::span<const CompletedVerb> verbs);

}  // namespace krok::cli
