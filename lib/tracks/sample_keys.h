#pragma once

#include <cstddef>
#include <span>

#include "tracks/keyed_clip.h"

namespace krok {

// How times before the start and after the end of something that lasts from 0 to `duration` are
// mapped.
enum class Wrap : unsigned char {
  clamp,     // hold the first or last value
  loop,      // repeat; the end is the start of the next cycle
  ping_pong  // alternate forwards and backwards
};

// Maps `time` to [0, duration], in any unit. loop gives less than `duration`, except that times
// within [0, duration] are unchanged. 0 if the duration is not positive and finite, if the time is
// NaN, or if it is infinite and `wrap` is not clamp.
double wrap_time(double time, double duration, Wrap wrap);

// Samples keyed clips at any time. Before a track's first key and after its last, that key holds.
// Nothing is allocated.

Vec3 sample_track(const VectorTrack& track, double time);
Quat sample_track(const RotationTrack& track, double time);

// The last sampled keys of a joint's tracks. If kept from call to call, times that advance in small
// steps are found in constant time, others by binary search. A cursor may be reset (zeros) at any
// time and never changes the result.
struct KeyCursor {
  std::size_t position = 0, rotation = 0, scale = 0;
};

// joint_to_parent of all joints at wrap_time(time, clip.duration, wrap); [joints] each. `scales`
// and `cursors` may be empty. The clip must pass check().
void sample_keys(const KeyedClip& clip, double time, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<Vec3> scales,
                 std::span<KeyCursor> cursors);

// One pose per time: [times x joints].
void sample_keys(const KeyedClip& clip, std::span<const double> times, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<KeyCursor> cursors);

// joint_to_world from joint_to_parent and scales: a scale moves the joints below it, as matrices
// do, but does not rotate them. `scaled_to_world` is scratch memory and receives the matrices with
// scales. Spans have [joints] elements and must not overlap.
void scaled_local_to_world(std::span<const int> parents, std::span<const Transform> joint_to_parent,
                           std::span<const Vec3> scales, std::span<Mat4> scaled_to_world,
                           std::span<Transform> joint_to_world);

}  // namespace krok
