#include "tools/cli/tool.h"
#include "tools/krok-morph/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::morph::make_spec, argc, argv);
}
