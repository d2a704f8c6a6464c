#pragma once

#include "core/file.h"
#include "core/result.h"
#include "formats/registry/registry.h"
#include "tools/cli/tool.h"
#include "tools/krok-import/options.h"

namespace krok::cli::import {

// Reads a scene and writes the requested parts: the motion of one or all of its animations, the
// character as a model, a camera, morph targets and their weights. All files appear or none. Fails
// (code import-missing) for parts that the file does not have.
Result<int> import_scene(const InputFile& input, const Options& options, ToolContext& context);

}  // namespace krok::cli::import
