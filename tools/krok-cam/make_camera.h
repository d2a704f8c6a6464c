#pragma once

#include "tools/common/tool.h"
#include "tools/krok-cam/options.h"

namespace krok::cam_tool {

// Makes or reads the camera and writes it. Codes cam-input, cam-format, cam-joint, and those of the
// functions it calls.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cam_tool
