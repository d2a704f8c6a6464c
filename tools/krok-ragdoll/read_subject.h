#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/fall.h"
#include "tools/krok-ragdoll/options.h"

namespace krok::cli::ragdoll {

// The motion, its roles, ranges and bodies, and motions to get up with. Errors name the file that
// they are of; a mesh that the bodies do not fill prints a warning (ragdoll-model).
Result<Subject> read_subject(const Options& options, ToolContext& context);

}  // namespace krok::cli::ragdoll
