#pragma once

#include <memory>
#include <string>

#include "core/progress.h"

namespace krok {

enum class ProgressStyle { automatic, bar, plain, json, none };

// A Progress on standard error. automatic: a bar on a terminal, nothing elsewhere. plain: a line at
// the start and at every tenth. json: {"progress": {"what", "done", "total"}} a line. A bar appears
// after half a second only, so that short work leaves the terminal alone. NO_COLOR is honoured.
std::unique_ptr<Progress> console_progress(ProgressStyle style);

}  // namespace krok
