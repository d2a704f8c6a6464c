#include "tools/batch/batch.h"
#include "tools/krok-edit/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::edit::make_spec, argc, argv);
}
