#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "filter/spikes.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// Removes noise whose level is estimated from the motion itself, and spikes.

namespace krok::filter {

struct NoiseRemoval {
  Clip clip;
  std::vector<Spike> spikes;  // by joint, rotations before positions, then by frame
  // The noise that was found: standard deviation about each axis, median of all joints (radians),
  // and of the root's position (metres). 0 if none was filtered.
  double angle = 0, distance = 0;
};

// 1. Spikes are replaced by remove_spikes() with its usual options.
// 2. Rotations are unrolled along a smoothed course (as in smooth_rotations()), in whose tangent
//    spaces noise of the rotations is noise of vectors. The deviation of each joint is estimated.
// 3. What is hidden in the noise from (1) is a spike, too: a frame that is further from the smooth
//    course of the others than 3 degrees or 10 mm, than 5 deviations of the noise, than 3.5 times
//    the usual distance (median over 1 s around), and than twice that of all but two of the ten
//    frames next to it. It is replaced by that course. What that throws aside is made good
//    (without_throws()).
// 4. without_noise() of all joints together, each in units of its noise.
//
// Preserves bone lengths, timing, frame rate and frame count. Joints with 0 in `joints` are
// unchanged, an empty span selects all joints; joints without noise (under 0.001 degrees or 0.01
// mm) too. Clips of fewer than 20 frames are returned as remove_spikes() makes them. Noise must be
// independent from frame to frame: what is slow, as drift is, counts as motion.
Result<NoiseRemoval> remove_noise(const Clip& clip, std::span<const std::uint8_t> joints,
                                  int jobs = 1);

struct NoiseFrames {
  FrameSource frames;
  double angle = 0, distance = 0;  // as in NoiseRemoval
};

// The same of frames generated on demand, in blocks of about `block_frames` with an overlap of 1200
// frames. How much noise there is, and how strongly each joint is smoothed, comes from eight
// samples of up to 2048 frames, spread evenly, and is the same in all blocks, so that nothing shows
// where they meet. Of an even noise the result is apart from that of remove_noise(clip) by less
// than a twentieth of the noise that either leaves (measured on a walk with noise of one degree);
// where noise comes and goes, by as much as the samples differ. Spikes are those of
// remove_spikes(), hidden ones nearly those of the whole (in a capture with 24,000 of them 99.8 %
// the same). The frames are read twice beforehand. `watch` (optional) gets each block before and
// after, one at a time, with the spikes that begin in the frames kept of it, numbered in the whole
// take. Errors are those of the source.
Result<NoiseFrames> remove_noise(
    const FrameSource& source, std::span<const std::uint8_t> joints, int jobs,
    const std::function<void(const FrameRun& before, const NoiseRemoval& after)>& watch = {},
    int block_frames = BlockSize().frames / 2);

}  // namespace krok::filter
