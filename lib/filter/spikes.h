#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/clip.h"

namespace krok::filter {

// Frames in which a joint jumps away and comes back, as trackers that lose a marker or swap two
// make them.
struct SpikeOptions {
  // How many times the usual deviation a spike must reach. The deviation of a frame is how far it
  // lies from the cubic through its neighbours; what is usual is the median of that over a second
  // about the frame (at most 512 frames), a robust scale as the median absolute deviation of
  // Hampel's filter is.
  double threshold = 6;
  double least_angle = 3 * kRadiansPerDegree;  // smaller deviations of rotations are no spikes
  double least_distance = 0.01;                // nor are those of positions; metres
  double longest = 0.05;  // seconds, rounded to frames, one at least and 32 at most
};

struct Spike {
  int joint = 0;
  // Two spikes with a sound frame between them are one.
  int first_frame = 0, last_frame = 0;
  bool of_position = false;  // the place relative to the parent, otherwise the rotation
  double size = 0;           // radians or metres, the largest distance from what replaced it
};

struct SpikeRemoval {
  Clip clip;
  std::vector<Spike> spikes;  // by joint, rotations before positions, then by frame
};

// Looks at the rotation of each joint relative to its parent, and at the positions of the root and
// of joints that move in their parents. A run of frames is a spike if both its ends lie further
// than the threshold from the cubic through two frames before and two after it; if the steps into
// it and out of it are twice as large as those just before and after, for a quick gesture gathers
// speed; and if the frames on either side agree among themselves. It is replaced by that cubic, in
// the rotations' tangent space. The clip's first or last frame by itself is one if the step to it
// is more than the threshold times those beside it. A jump that does not come back is no spike.
//
// Joints with 0 in `joints` are left alone; an empty span selects all. Without spikes the clip
// comes back bit for bit. Clips of fewer than five frames have none. Codes: filter-threshold for
// options that are not positive.
Result<SpikeRemoval> remove_spikes(const Clip& clip, const SpikeOptions& options,
                                   std::span<const std::uint8_t> joints, int jobs = 1);

}  // namespace krok::filter
