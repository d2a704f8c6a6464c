#pragma once

#include <string>

#include "formats/container/packed_orientation.h"
#include "retarget/retarget.h"
#include "tools/common/tool.h"

namespace krok::retarget_tool {

// The options as given.
struct Options {
  std::string input;
  std::string onto;
  std::string map;       // of the input's joints; empty: none
  std::string onto_map;  // of the target's joints
  retarget::Feet feet = retarget::Feet::keep;
  std::string scale;                    // empty: ratio of leg lengths
  std::string reference_pose = "auto";  // auto, or a frame
  std::string onto_reference_pose = "auto";
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

void declare(CommandOptions& command, Options& options);

// Checks the options for values that are invalid for any file.
Status check(const Options& options);

// Reads the motion and the target, and writes the motion on the target's skeleton. Codes: those of
// the readers, of formats/role_map and of lib/retarget.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::retarget_tool
