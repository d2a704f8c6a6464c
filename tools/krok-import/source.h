#pragma once

#include "capture/capture.h"
#include "core/file.h"
#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/registry/registry.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// A capture of any format, and the format-specific part of its report.
struct Source {
  Capture capture;
  Json details = Json::object();
};

// The BVH-specific part of the report, and the options for reading BVH.
Json details_of(const bvh::Capture& capture);
bvh::ReadOptions bvh_options(const Options& options, const CaptureOptions& how);

// Reads a capture of any format; an AMC with its skeleton, given or found beside it. Unknown
// formats get the error of the BVH reader.
Result<Source> read_source(const InputFile& input, registry::Kind kind, const Options& options,
                           ToolContext& context);

}  // namespace krok::import
