#include "tools/batch/batch.h"
#include "tools/krok-retarget/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::retarget::make_spec, argc, argv);
}
