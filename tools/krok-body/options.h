#pragma once

#include <string>

#include "body/body.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"

namespace krok::cli::body {

struct Options {
  std::string input;
  BodyDetail detail = BodyDetail::medium;
  std::string pose = "auto";  // auto, reference, or a frame
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Code usage for an invalid pose.
Result<BodyOptions> body_options(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::body
