#include "tools/batch/batch.h"
#include "tools/krok-ik/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::ik::make_spec, argc, argv);
}
