#include "tools/cli/tool.h"
#include "tools/krok-fit/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::fit::make_spec, argc, argv);
}
