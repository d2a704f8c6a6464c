#pragma once

#include <optional>

#include "core/file.h"
#include "core/result.h"
#include "formats/registry/registry.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// Imports a BVH file without holding its motion in memory as a whole. Nothing where that cannot be
// done: another format, an option that needs all frames at once, a file with some fault. Nothing
// was told or written then, and the way over read_source, which tells faults, is to be taken.
std::optional<Result<int>> stream_capture(const InputFile& input, registry::Kind kind,
                                          const Options& options, ToolContext& context);

}  // namespace krok::import
