#pragma once

#include "capture/capture.h"
#include "core/file.h"
#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/registry/registry.h"
#include "tools/common/tool.h"
#include "tools/krok-import/options.h"

namespace krok::import {

// A capture of any format, and what the report says of it beyond what all have.
struct Source {
  Capture capture;
  Json details = Json::object();
};

// What the report says of a BVH file beyond what all captures have, and how one is read.
Json details_of(const bvh::Capture& capture);
bvh::ReadOptions bvh_options(const Options& options, const CaptureOptions& how);

// Reads a capture, whichever of the formats it is in; an AMC with its skeleton, given or found.
// What is none is refused as the BVH reader refuses it.
Result<Source> read_source(const InputFile& input, registry::Kind kind, const Options& options,
                           ToolContext& context);

}  // namespace krok::import
