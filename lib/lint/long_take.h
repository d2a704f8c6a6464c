#pragma once

#include <functional>

#include "core/result.h"
#include "lint/lint.h"
#include "scene/frame_source.h"

// Faults of takes that do not fit in memory.

namespace krok::lint {

// What `judge`, such as lint_motion(), finds in parts of a take of about 32 MB each. A fault
// belongs to the part that its worst frame is in, one that goes on into the next part is one. What
// is usual in the motion is judged within a part and the 10 seconds around it: a take of one part
// has the faults that `judge` finds in it, a longer one those of its minutes rather than of the
// whole. The ends of a loop are compared by themselves.
//
// `judge` is called in the order of the parts. Codes: those of the source.
Result<MotionFaults> lint_long_take(
    const FrameSource& motion, const MotionOptions& options, int jobs,
    const std::function<MotionFaults(const Clip& part, const MotionOptions& how)>& judge,
    std::size_t part_bytes = std::size_t{32} << 20);

}  // namespace krok::lint
