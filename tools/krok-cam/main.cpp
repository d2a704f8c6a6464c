#include "tools/batch/batch.h"
#include "tools/krok-cam/options.h"

int main(int argc, char** argv) {
  return krok::cli::batch::run_tool(krok::cli::cam::make_spec, argc, argv);
}
