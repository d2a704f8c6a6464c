#pragma once

#include <string>

#include "body/body.h"
#include "formats/container/packed_orientation.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::body {

// `frame` only for BodyPose::frame.
struct Pose {
  BodyPose kind = BodyOptions().pose;
  int frame = 0;
};

struct Options {
  std::string input;
  BodyDetail detail = BodyDetail::medium;
  Pose pose;
  TwistJoints twist;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads a skeleton, generates the body and writes it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::body
