#include "tools/batch/batch.h"
#include "tools/krok-skin/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::skin::make_spec, argc, argv);
}
