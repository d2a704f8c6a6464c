#include "tools/krok-morph/options.h"

#include "tools/krok-morph/actions.h"

namespace krok::cli::morph {

Result<int> run(const Options& options, ToolContext& context) {
  switch (options.action) {
    case Action::pack:
      return pack(options, context);
    case Action::unpack:
      return unpack(options, context);
    case Action::info:
      return info(options, context);
    case Action::bake:
      return bake(options, context);
    case Action::frames:
      return frames(options, context);
  }
  return Error("internal", "unknown action");
}

}  // namespace krok::cli::morph
