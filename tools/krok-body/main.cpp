#include "tools/batch/batch.h"
#include "tools/krok-body/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::body::make_spec, argc, argv);
}
