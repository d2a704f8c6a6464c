#pragma once

#include <cstddef>
#include <cstdint>

// The arithmetic of joint_tracks, vectorised over frames. Plain pointers and numbers only: an
// inline function that is compiled for several instruction sets might be kept in a form that the
// machine cannot run.

namespace krok::gltf::track_detail {

// What the nodes are, and which of them are taken to have tracks.
struct Nodes {
  const int* parents;  // -1 for the root
  std::size_t joints;
  const float* rest_translations;  // [joints x 3]
  const float* rest_rotations;     // [joints x 4], x, y, z, w
  const std::uint8_t* tracks;      // [joints], kRotates and kMoves or-ed
  double position_tolerance;       // metres
  double angle_tolerance;          // radians
};
inline constexpr std::uint8_t kRotates = 1;
inline constexpr std::uint8_t kMoves = 2;

// Where a joint's values go, one frame after the other; null for a joint without that track.
struct Places {
  float* rotations;     // [frames x 4]
  float* translations;  // [frames x 3]
};

// Doubles of scratch for joint_tracks(), a joint.
inline constexpr std::size_t kScratch = 7 * 16;

// Frames with joint_to_world as floats, [frames x joints x 3] and [frames x joints x 4], in the
// terms of each joint's parent as a viewer rebuilds it. Signs of the rotations are as they come.
// Adds to `seen` [joints] which tracks the frames ask for, given those of the ancestors. `scratch`
// stands on a 64-byte boundary.
void joint_tracks(const Nodes& nodes, const float* positions, const float* orientations,
                  std::size_t frames, const Places* places, double* scratch, std::uint8_t* seen);

}  // namespace krok::gltf::track_detail
