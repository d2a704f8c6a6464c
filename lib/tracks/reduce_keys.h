#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"

// Key reduction: removes keys where linear interpolation of positions and slerp of rotations
// between the remaining ones keeps every joint within a tolerance. The error is measured in model
// space, including what accumulates along a chain, at each joint and on a sphere of points around
// it that represents the skin (the "rigid shell" of the Animation Compression Library), at each
// frame on the curves that are returned.

namespace krok {

struct ReduceOptions {
  double tolerance = 1e-4;       // metres, > 0
  double shell_distance = 0.03;  // metres from a joint to the skin around it, >= 0
  // Instead of it, one for each joint, or none.
  std::span<const double> shell_distances{};
  // Tracks that would keep more than this fraction keep all their keys, for formats where separate
  // times per track cost more than a few values; 1 gives the fewest keys.
  double most_kept = 1;
  // joint_to_parent of joints without keys, [joints], or none: tracks that stay there get no keys.
  std::span<const Transform> rest{};
};

// Frames of a joint that are kept as keys, increasing; only the first if nothing moves,
// none at rest.
struct KeptFrames {
  std::vector<int> position;
  std::vector<int> rotation;
};

struct Reduction {
  std::vector<KeptFrames> joints;  // [joints]
  double largest_error = 0;        // metres, <= tolerance
  int worst_joint = 0, worst_frame = 0;
  std::size_t keys_before = 0, keys_after = 0;
};

// joint_to_parent of all frames: [frames x joints], frame by frame; rotations unit, of either sign.
// `times` are seconds, strictly increasing. Runs on up to `jobs` threads (as in parallel_for),
// which does not change the result. Codes: reduce-tolerance for options out of range, reduce-joints
// for more than a million pairs of a joint that moves and one below it (a chain of 1,400).
Result<Reduction> choose_keys(std::span<const int> parents, std::span<const double> times,
                              std::span<const Transform> joint_to_parent,
                              const ReduceOptions& options, int jobs = 1);

}  // namespace krok
