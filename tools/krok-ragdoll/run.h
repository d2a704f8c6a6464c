#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/options.h"

namespace krok::cli::ragdoll {

// Reads the motion, model, limits and ground; writes the motion with its fall. A character that
// does not come to rest is a warning (ragdoll-moving). Codes: those of the readers, formats/limits
// and lib/ragdoll; ragdoll-joint for a joint of an option that the motion has not, ragdoll-time for
// times outside it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::ragdoll
