#pragma once

#include "body/body.h"
#include "core/result.h"
#include "scene/frame_source.h"

// Bodies for takes that do not fit in memory.

namespace krok {

// As of a clip with these frames, of which a few are read. Errors are those of the source, too.
Result<Body> make_body(const FrameSource& source, const BodyOptions& options = {});

}  // namespace krok
