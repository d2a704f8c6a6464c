#include "tools/krok/program.h"

// The program krok-VERB, or krok; the build defines KROK_VERB.
int main(int argc, char** argv) {
  return krok::cli::run_program(KROK_VERB, argc, argv);
}
