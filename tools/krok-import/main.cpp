#include "tools/batch/batch.h"
#include "tools/krok-import/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::import::make_spec, argc, argv);
}
