#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/transform.h"
#include "tracks/reduce_keys.h"

// Private to this folder: the search for keys in a stretch of frames.

namespace krok::tracks_detail {

// A track: the position (even numbers) or the rotation (odd ones) of a joint, 2 joint + 0 or 1.
inline constexpr std::size_t kTracksPerJoint = 2;

enum class Keep : unsigned char {
  first,   // the value of frame 0 serves for all
  needed,  // keys are taken out where they can be spared
  all
};

// What all stretches of a motion share.
struct ReductionTask {
  std::span<const int> parents;
  std::span<const double> times;        // of all frames
  std::span<const Transform> local;     // [frames x joints]
  std::vector<Keep> keep;               // [tracks]
  std::vector<std::vector<int>> below;  // [joints]: the joint and all that hang on it, rising
  ReduceOptions options;
};

struct StretchResult {
  std::vector<std::vector<int>> keys;  // [tracks], frames of the motion, rising; none if still
  double largest_error = 0;
  int worst_joint = 0, worst_frame = 0;
};

// The keys of frames [begin, end), two or more or the only one; tracks that move get keys at both
// ends.
StretchResult reduce_stretch(const ReductionTask& task, std::size_t begin, std::size_t end);

// How far `reduced` is from `original`, both joint_to_world: an upper bound over a sphere of points
// around the joint.
double shell_error(const Transform& original, const Transform& reduced, double shell_distance);

// The same for a rotation alone and points at most `reach` metres away.
double rotation_error(const Quat& original, const Quat& reduced, double reach);

}  // namespace krok::tracks_detail
