#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/far_values.h"
#include "core/result.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/row_frames.h"

namespace krok::bvh {

// Diagnostics for implausibly large values in rows, `far` of `frames`: the first rotation and the
// first position, each with joint, frame and location. Codes bvh-far-rotation, bvh-far-position.
std::vector<Error> far_row_faults(std::string_view text, const RowFrames& frames,
                                  const FarValues& far, const Hierarchy& hierarchy,
                                  const std::string& file_name);

}  // namespace krok::bvh
