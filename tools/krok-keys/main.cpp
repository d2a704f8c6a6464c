#include "tools/batch/batch.h"
#include "tools/krok-keys/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::keys::make_spec, argc, argv);
}
