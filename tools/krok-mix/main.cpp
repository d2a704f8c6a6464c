#include "tools/batch/batch.h"
#include "tools/krok-mix/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::mix::make_spec, argc, argv);
}
