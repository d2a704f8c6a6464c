#include "tools/cli/tool.h"
#include "tools/krok-diff/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::diff::make_spec, argc, argv);
}
