#include "tools/batch/batch.h"
#include "tools/krok-render/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::film::make_spec, argc, argv);
}
