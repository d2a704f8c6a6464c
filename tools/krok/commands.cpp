
#include <algorithm>
#include <array>

#include "tools/batch/batch.h"
#include "tools/cli/command_line.h"
#include "tools/krok/krok.h"
#include "tools/krok/program.h"

// Verbs, and the namespaces of their tools. OWN: see Command::own_program.
#define KROK_COMMANDS(ROW, OWN) \
  ROW("import", import)         \
  ROW("export", exporting)      \
  ROW("info", info)             \
  ROW("body", body)             \
  ROW("skin", skin)             \
  ROW("morph", morph)           \
  ROW("retarget", retarget)     \
  ROW("ik", ik)                 \
  ROW("ragdoll", ragdoll)       \
  ROW("edit", edit)             \
  ROW("keys", keys)             \
  ROW("blend", blend)           \
  ROW("mix", mix)               \
  ROW("cam", cam)               \
  OWN("fit", fit)               \
  ROW("synth", synth)           \
  ROW("walk", walk)             \
  ROW("view", view)             \
  ROW("render", film)           \
  ROW("plot", plot)             \
  ROW("diff", diff)             \
  ROW("lint", lint)

namespace krok::cli {

#define KROK_DECLARE(verb, space) \
  namespace space {               \
  ToolSpec make_spec();           \
  }
KROK_COMMANDS(KROK_DECLARE, KROK_DECLARE)
#undef KROK_DECLARE

std::span<const Command> commands() {
#define KROK_ROW(verb, space) Command{verb, space::make_spec, false},
#define KROK_OWN(verb, space) Command{verb, space::make_spec, true},
  static constexpr auto kCommands = std::to_array<Command>({KROK_COMMANDS(KROK_ROW, KROK_OWN)});
#undef KROK_ROW
#undef KROK_OWN
  return kCommands;
}

const Command* find_command(std::string_view verb) {
  const auto found = std::ranges::find(commands(), verb, &Command::verb);
  return found == commands().end() ? nullptr : &*found;
}

std::vector<ToolOption> options_of_all_tools() {
  std::vector<ToolOption> options;
  for (const Command& command : commands()) {
    const ToolSpec spec = command.make_spec();
    for (OptionFacts& facts : CommandLine(spec, CommandLine::Form::single).options()) {
      options.push_back({spec.name, std::move(facts)});
    }
  }
  return options;
}

int run_program(const char* verb, int argc, char** argv) {
  const Command* command = find_command(verb);
  if (command == nullptr) return run_krok(argc, argv);
  const auto make_spec = [command] {
    ToolSpec spec = command->make_spec();
    spec.options_of_all = options_of_all_tools;
    return spec;
  };
  return batch::run_tool(make_spec, argc, argv);
}

}  // namespace krok::cli
