#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "core/result.h"
#include "filter/butterworth.h"
#include "filter/savitzky_golay.h"
#include "scene/clip.h"
#include "scene/frame_blocks.h"

namespace krok::filter {

using Smoothing = std::variant<Butterworth, SavitzkyGolay>;

// Removes jitter per joint: local rotations by smooth_rotations; positions of the root and of
// joints that translate relative to their parents by smooth_positions. Preserves bone lengths,
// timing, frame rate and frame count. Joints with 0 in `joints` keep their local rotation and
// position; an empty span selects all joints. Clips of fewer than three frames, or shorter than the
// window of a SavitzkyGolay, are returned unchanged. Codes: those of the filters.
Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs = 1);

// The same of frames generated on demand, in blocks of `block_frames` with an overlap in which the
// effect of their ends dies away: the same bytes up to one block, beyond it within 1e-6 rad and m.
// Near the first and last frame of a longer take, where a Butterworth's initial state has not died
// away either, it is within 3e-5 (order 8; measured on a noisy walk). The frames are read once
// beforehand, for which joints translate. `watch` (optional) gets each block before and after, one
// at a time.
Result<FrameSource> smooth(
    const FrameSource& source, const Smoothing& smoothing, std::span<const std::uint8_t> joints,
    int jobs, const std::function<void(const FrameRun& before, const Clip& after)>& watch = {},
    int block_frames = BlockSize().frames);

}  // namespace krok::filter
