#include "tools/batch/batch.h"
#include "tools/krok-ragdoll/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::ragdoll::make_spec, argc, argv);
}
