#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/spikes.h"
#include "scene/clip.h"

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
//    frames next to it. It is replaced by that course.
// 4. without_noise() of all joints together, each in units of its noise.
//
// Preserves bone lengths, timing, frame rate and frame count. Joints with 0 in `joints` are
// unchanged, an empty span selects all joints; joints without noise (under 0.001 degrees or 0.01
// mm) too. Clips of fewer than 20 frames are returned as remove_spikes() makes them. Noise must be
// independent from frame to frame: what is slow, as drift is, counts as motion.
Result<NoiseRemoval> remove_noise(const Clip& clip, std::span<const std::uint8_t> joints,
                                  int jobs = 1);

}  // namespace krok::filter
