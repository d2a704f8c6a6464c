#include "tools/cli/tool.h"
#include "tools/krok-blend/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::blend::make_spec, argc, argv);
}
