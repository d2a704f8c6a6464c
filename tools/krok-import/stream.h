#pragma once

#include <optional>

#include "core/file.h"
#include "core/result.h"
#include "formats/registry/registry.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// Imports a BVH file without holding the whole motion in memory. Returns nothing if that is
// impossible: another format, an option that needs all frames at once, a damaged file. Nothing was
// printed or written then; use read_source, which reports the damage.
std::optional<Result<int>> stream_capture(const InputFile& input, registry::Kind kind,
                                          const Options& options, ToolContext& context);

}  // namespace krok::import
