#pragma once

#include <cstddef>
#include <cstdint>

// The SIMD kernel of joint_tracks, vectorised over frames. Plain pointers and numbers only: of an
// inline function compiled for several instruction sets, the linker might keep a version that the
// CPU cannot run.

namespace krok::gltf::track_detail {

// The nodes, and which of them are assumed to have tracks.
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

// Output of a joint, by frame; null for a joint without that track.
struct Places {
  float* rotations;     // [frames x 4]
  float* translations;  // [frames x 3]
};

// Doubles of scratch memory for joint_tracks(), per joint.
inline constexpr std::size_t kScratch = std::size_t{7} * 16;

// Converts joint_to_world, [frames x joints x 3] and [frames x joints x 4], to transforms relative
// to each joint's parent as a viewer rebuilds it. Signs of the rotations are arbitrary. Adds to
// `seen` [joints] the tracks that the frames need, given those of the ancestors. `scratch` must be
// aligned to 64 bytes.
void joint_tracks(const Nodes& nodes, const float* positions, const float* orientations,
                  std::size_t frames, const Places* places, double* scratch, std::uint8_t* seen);

}  // namespace krok::gltf::track_detail
