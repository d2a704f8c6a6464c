#pragma once

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-morph/options.h"

namespace krok::cli::morph {

// One function per action; the options have been checked. Codes, besides those of readers and
// writers: morph-input, morph-empty, morph-vertices, morph-triangles, morph-name, morph-target,
// morph-format, morph-clip-too-long, morph-too-large.
Result<int> pack(const Options& options, ToolContext& context);
Result<int> unpack(const Options& options, ToolContext& context);
Result<int> info(const Options& options, ToolContext& context);
Result<int> bake(const Options& options, ToolContext& context);
Result<int> frames(const Options& options, ToolContext& context);

}  // namespace krok::cli::morph
