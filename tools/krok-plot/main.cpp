#include "tools/krok-plot/plot.h"

int main(int argc, char** argv) {
  return krok::run_tool(krok::plot::make_spec, argc, argv);
}
