#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_options.h"
#include "tools/cli/option_search.h"
#include "tools/cli/tool.h"

// The table of commands, and what krok alone does: completion in shells, git.

namespace krok::cli {

// A row of the table of commands. `krok VERB`, its help, completion in shells and the tests take
// names, summaries and options from it.
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

std::vector<ToolOption> options_of_all_tools();

// The main of krok: `krok VERB ...` is `krok-VERB ...`. Returns the exit code.
int run_krok(int argc, char** argv);

struct CompletedVerb {
  std::string name;  // "skin"
  std::string does;
  std::vector<OptionFacts> options;
};

enum class Shell : unsigned char { bash, zsh, fish };

// Completes krok and its tools by the options that they declare; a script that the shell sources.
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
