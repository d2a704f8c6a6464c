#include "tools/batch/batch.h"
#include "tools/krok-plot/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::plot::make_spec, argc, argv);
}
