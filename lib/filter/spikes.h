#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "motion/local_motion.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok::filter {

// Detection of spikes: frames in which a joint jumps away and back, as when a tracker loses or
// swaps markers.
struct SpikeOptions {
  // Threshold as a multiple of the usual deviation. The deviation of a frame is its distance from
  // the cubic through its neighbours; the usual deviation is its median over one second around the
  // frame (21 to 513 frames), a robust scale like the median absolute deviation of Hampel's filter.
  double threshold = 6;
  double least_angle = 3 * kRadiansPerDegree;  // radians; smaller deviations are ignored
  double least_distance = 0.01;  // metres; smaller deviations of positions are ignored
  double longest = 0.05;         // max duration in seconds, rounded to frames, from 1 to 32
};

struct Spike {
  int joint = 0;
  // Two spikes with one valid frame between them are reported as one.
  int first_frame = 0, last_frame = 0;
  bool of_position = false;  // local position, otherwise local rotation
  double size = 0;           // radians or metres, the largest distance from the replacement
};

struct SpikeRemoval {
  Clip clip;
  std::vector<Spike> spikes;  // by joint, rotations before positions, then by frame
};

// Replaces spikes in the local rotation of each joint and in the positions of the root and of
// joints that translate relative to their parents. A run of frames is a spike if its first and last
// frame are further than the threshold from the cubic through two frames before and two after it;
// if the steps into and out of it are more than twice as large as the steps just before and after,
// unlike in a fast gesture, which accelerates; and if the frames on either side are within the
// threshold. It is replaced by that cubic, for rotations in the tangent space. The first or last
// frame of the clip is a spike if the step to it is more than the threshold times the steps next to
// it. A jump that does not return is not a spike.
//
// Where joints below are thrown aside by that, by half of `least_distance` or more (a fit to
// markers turned them back), those between are replaced in the same frames, and are listed, too;
// where they are thrown even so, the spike stays.
//
// Joints with 0 in `joints` are unchanged; an empty span selects all joints. Without spikes the
// clip is returned bit for bit. Clips of fewer than five frames have none. Codes: filter-threshold
// for options that are not positive and finite.
Result<SpikeRemoval> remove_spikes(const Clip& clip, const SpikeOptions& options,
                                   std::span<const std::uint8_t> joints, int jobs = 1);

// The same of frames generated on demand, in blocks that overlap by what a spike's limit depends
// on: the same bytes up to one block; beyond it the same spikes and replacements, and a block
// without spikes, with its overlap, is unchanged bit for bit. The frames are read once beforehand,
// for which joints translate. `watch` (optional) gets each block before and after, one at a time,
// with the spikes that begin in the frames kept of it, numbered in the whole take.
Result<FrameSource> remove_spikes(
    const FrameSource& source, const SpikeOptions& options, std::span<const std::uint8_t> joints,
    int jobs,
    const std::function<void(const FrameRun& before, const SpikeRemoval& after)>& watch = {},
    int block_frames = BlockSize().frames / 2);

// Into the order of SpikeRemoval::spikes.
void sort_spikes(std::vector<Spike>& spikes);

// Makes good what replaced spikes throw aside by over `most` metres, as remove_spikes() does:
// `motion` is that of the clip `before`, with its spikes replaced.
SpikeRemoval without_throws(const Clip& before, double most, std::span<const std::uint8_t> joints,
                            LocalMotion& motion, const std::vector<Spike>& spikes);

}  // namespace krok::filter
