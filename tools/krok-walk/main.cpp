#include "tools/cli/tool.h"
#include "tools/krok-walk/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::walk::make_spec, argc, argv);
}
