#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "tracks/reduce_keys.h"

// Private to this folder: key selection in a chunk of frames.

namespace krok::tracks_detail {

// A track is the position (even) or the rotation (odd) of a joint: 2 joint + 0 or 1.
inline constexpr std::size_t kTracksPerJoint = 2;

enum class Keep : unsigned char {
  rest,    // no keys: the value of ReduceOptions::rest
  first,   // constant: the value of frame 0
  needed,  // keys are removed where possible
  all
};

// Input shared by all chunks of a motion.
struct ReductionTask {
  std::span<const int> parents;
  std::span<const double> times;     // of all frames
  std::span<const Transform> local;  // [frames x joints]
  std::vector<Keep> keep;            // [tracks]
  // [joints]: the joint and its descendants, increasing; empty for those that keep their keys.
  std::vector<std::vector<int>> below;
  ReduceOptions options;

  // What a track without keys, or with one, shows at all frames.
  const Transform& constant(std::size_t track) const {
    const std::size_t joint = track / kTracksPerJoint;
    return keep[track] == Keep::rest ? options.rest[joint] : local[joint];
  }
  double shell_of(std::size_t joint) const {
    return options.shell_distances.empty() ? options.shell_distance
                                           : options.shell_distances[joint];
  }
};

struct StretchResult {
  std::vector<std::vector<int>> keys;  // [tracks], frames of the motion; none if constant
  double largest_error = 0;
  int worst_joint = 0, worst_frame = 0;
};

// Takes all keys from the tracks whose motion is hardly seen, as far as the tolerance allows. For
// one chunk of frames: it holds all of them several times.
void put_to_rest(ReductionTask& task);

// The keys of frames [begin, end), two or more or the only one; tracks that move get keys at both
// ends.
StretchResult reduce_stretch(const ReductionTask& task, std::size_t begin, std::size_t end);

// The error of `reduced` against `original`, both joint_to_world: an upper bound over a sphere of
// points around the joint.
double shell_error(const Transform& original, const Transform& reduced, double shell_distance);

// Same for a rotation alone and points at most `reach` metres away.
double rotation_error(const Quat& original, const Quat& reduced, double reach);

}  // namespace krok::tracks_detail
