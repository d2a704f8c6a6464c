#include "tools/cli/tool.h"
#include "tools/krok-view/options.h"

int main(int argc, char** argv) {
  return krok::cli::run_tool(krok::cli::view::make_spec, argc, argv);
}
