#include "tools/cli/tool.h"
#include "tools/krok-info/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::info::make_spec, argc, argv);
}
