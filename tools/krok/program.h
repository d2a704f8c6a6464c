#pragma once

namespace krok::cli {

// The main of krok-VERB, or of krok for an empty verb: all that the library of the tools shows to
// programs. Returns the exit code.
[[gnu::visibility("default")]] int run_program(const char* verb, int argc, char** argv);

}  // namespace krok::cli
