#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_options.h"

// Completion of krok and its tools in shells, generated from the options that the tools declare.

namespace krok::cli {

// The main of krok: `krok VERB ...` is `krok-VERB ...`. Returns the exit code.
int run_krok(int argc, char** argv);

struct CompletedVerb {
  std::string name;  // "skin"
  std::string does;
  std::vector<OptionFacts> options;
};

enum class Shell : unsigned char { bash, zsh, fish };

// A script that the shell sources.
std::string completion_script(Shell shell, std::span<const CompletedVerb> verbs);

// `krok git-setup`: prepares the repository of the current folder for motions.
//
// - .gitattributes gets a line for each ending of a motion that it lacks: diff=krok, merge=krok.
// - diff.krok.textconv is `krok info --textconv`, with cachetextconv.
// - merge.krok.driver refuses: motions that both sides changed are a conflict, and the file stays
//   as it was; the message says how to choose a side.
// - With --hook, the hook pre-commit runs krok lint on the motions that are committed. A hook that
//   is there already stays.
//
// Returns an exit code.
int git_setup(const std::vector<std::string>& arguments);

}  // namespace krok::cli
