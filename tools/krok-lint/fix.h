#pragma once

#include <vector>

#include "core/result.h"
#include "tools/krok-lint/linted_file.h"

namespace krok::cli::lint {

// --fix OUT_DIR: writes NAME.anim there for each motion with faults that can be mended: spikes are
// removed as by `krok edit --spikes`, sliding feet planted as by `krok ik --plant`. Says for each
// what was changed, and which faults are left when the result is judged again. Inputs stay as they
// are. Code lint-fix where two motions would have one name.
Status fix_all(const Options& options, const krok::lint::MotionOptions& how,
               const std::vector<LintedFile>& files, const io::FindRoles& find_roles,
               ToolContext& context);

}  // namespace krok::cli::lint
