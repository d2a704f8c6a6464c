#pragma once

#include <span>
#include <vector>

#include "tracks/keyed_clip.h"

// Fewer keys for the same motion: keys are left out where linear interpolation of positions and
// slerp of rotations between those that stay bring every joint where it was, within a tolerance.
// What counts is the error in the model's space, all that adds up along a chain included, at each
// joint and on a sphere of points around it that stands for the skin (the "rigid shell" of the
// Animation Compression Library). It is measured at each frame on the very curves that come out.

namespace krok {

struct ReduceOptions {
  double tolerance = 1e-4;       // metres, > 0
  double shell_distance = 0.03;  // metres from a joint to the skin around it, >= 0
  // Tracks of which more than this part would stay keep all their keys, for formats where times of
  // a track's own cost more than a few values; 1 for the fewest keys.
  double most_kept = 1;
};

// Which frames of a joint stay as keys, rising; the first alone where nothing moves.
struct KeptFrames {
  std::vector<int> position;
  std::vector<int> rotation;
};

struct Reduction {
  std::vector<KeptFrames> joints;  // [joints]
  double largest_error = 0;        // metres, at most the tolerance
  int worst_joint = 0, worst_frame = 0;
  std::size_t keys_before = 0, keys_after = 0;
};

// joint_to_parent of all frames: [frames x joints], frame by frame; rotations unit, of either sign.
// `times` rise strictly, seconds. On up to `jobs` threads (as in parallel_for), which do not change
// the result. Codes: reduce-tolerance for options out of range.
Result<Reduction> choose_keys(std::span<const int> parents, std::span<const double> times,
                              std::span<const Transform> joint_to_parent,
                              const ReduceOptions& options, int jobs = 1);

// A clip with the keys that choose_keys() leaves. A clip without frames gives one without keys.
struct ReducedClip {
  KeyedClip clip;
  Reduction reduction;
};
Result<ReducedClip> reduce_keys(const Clip& clip, const ReduceOptions& options, int jobs = 1);

}  // namespace krok
