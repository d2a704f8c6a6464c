#include "tools/cli/tool.h"
#include "tools/krok-synth/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::synth::make_spec, argc, argv);
}
