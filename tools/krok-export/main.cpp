#include "tools/batch/batch.h"
#include "tools/krok-export/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::exporting::make_spec, argc, argv);
}
