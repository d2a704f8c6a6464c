#pragma once

#include "tools/cli/tool.h"
#include "tools/krok-cam/options.h"

namespace krok::cli::cam {

// Makes or reads the camera and writes it. Codes cam-input, cam-format, cam-joint, and those of the
// functions it calls.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::cam
