#pragma once

#include <cstddef>
#include <span>

#include "math/wrap_time.h"
#include "tracks/keyed_clip.h"

// Keyed clips at any time. Before a track's first key its first value holds, after its last the
// last. Nothing is allocated.

namespace krok {

Vec3 sample_track(const VectorTrack& track, double time);
Quat sample_track(const RotationTrack& track, double time);

// Where a joint's tracks were sampled last. With one that is kept from call to call, times that
// move on bit by bit cost the same however many keys there are; others a binary search. A cursor
// may be new (zeros) at any time and never changes the result.
struct KeyCursor {
  std::size_t position = 0, rotation = 0, scale = 0;
};

// joint_to_parent of all joints at wrap_time(time, clip.duration, wrap); [joints] each. `scales`
// may be empty, and so may `cursors`. The clip passes check().
void sample_keys(const KeyedClip& clip, double time, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<Vec3> scales,
                 std::span<KeyCursor> cursors);

// Many times, one pose after the other: [times x joints].
void sample_keys(const KeyedClip& clip, std::span<const double> times, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<KeyCursor> cursors);

// joint_to_world from joint_to_parent and scales: a scale moves what is below its joint as matrices
// do, and turns nothing. `scaled_to_world` is working space and receives the matrices with their
// scales. Spans have [joints] elements and do not overlap.
void scaled_local_to_world(std::span<const int> parents, std::span<const Transform> joint_to_parent,
                           std::span<const Vec3> scales, std::span<Mat4> scaled_to_world,
                           std::span<Transform> joint_to_world);

}  // namespace krok
