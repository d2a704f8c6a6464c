#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "core/result.h"
#include "filter/butterworth.h"
#include "filter/savitzky_golay.h"
#include "scene/clip.h"

namespace krok::filter {

using Smoothing = std::variant<Butterworth, SavitzkyGolay>;

// Removes jitter per joint: local rotations by smooth_rotations; positions of the root and of
// joints that translate relative to their parents by smooth_positions. Preserves bone lengths,
// timing, frame rate and frame count. Joints with 0 in `joints` keep their local rotation and
// position; an empty span selects all joints. Clips of fewer than three frames, or shorter than the
// window of a SavitzkyGolay, are returned unchanged. Codes: those of the filters.
Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs = 1);

}  // namespace krok::filter
