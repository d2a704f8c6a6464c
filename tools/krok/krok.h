#pragma once

namespace krok::cli {

// The main of krok: `krok VERB ...` is `krok-VERB ...`. Returns the exit code.
int run_krok(int argc, char** argv);

}  // namespace krok::cli
