#pragma once

#include <string>

#include "body/body.h"
#include "formats/container/packed_orientation.h"
#include "tools/common/tool.h"

namespace krok::body_tool {

struct Options {
  std::string input;
  BodyDetail detail = BodyDetail::medium;
  std::string pose = "auto";  // auto, reference, or a frame
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

void declare(CommandOptions& command, Options& options);

// Checks the options for values that are invalid for any file.
Status check(const Options& options);

// Reads a skeleton, generates the body and writes it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::body_tool
