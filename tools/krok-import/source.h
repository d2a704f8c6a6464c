#pragma once

#include "capture/capture.h"
#include "core/result.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// A capture of any format, and what the report says of it beyond what all have.
struct Source {
  Capture capture;
  Json details = Json::object();
};

// Reads the input, whichever of the formats it is in; an AMC with its skeleton, given or found.
Result<Source> read_source(const Options& options, ToolContext& context);

}  // namespace krok::import
