#include "tools/krok-edit/edit.h"

int main(int argc, char** argv) {
  return krok::run_tool(krok::edit::make_spec, argc, argv);
}
