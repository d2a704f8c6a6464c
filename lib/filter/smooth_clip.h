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

// Filters a motion against jitter, joint by joint: rotations relative to the parent by
// smooth_rotations, positions of the root and of joints that move in their parents by
// smooth_positions. Bones keep their lengths; nothing is shifted in time; rate and number of frames
// stay. Joints with 0 in `joints` keep their rotation relative to the parent; an empty span selects
// all. A clip of fewer than three frames comes back as it is, as does one shorter than the window
// of a SavitzkyGolay. Codes: those of the filters.
Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs = 1);

}  // namespace krok::filter
