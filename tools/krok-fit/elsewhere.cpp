#include "tools/krok-fit/options.h"

namespace krok::cli::fit {

// For the library of all tools, which knows krok-fit's options and not its work.
Result<int> run(const Options&, ToolContext&) {
  return Error("internal", "krok-fit is a program of its own");
}

}  // namespace krok::cli::fit
