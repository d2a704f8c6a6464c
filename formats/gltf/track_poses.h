#pragma once

#include <span>
#include <vector>

#include "formats/gltf/joint_tracks.h"

namespace krok::gltf {

// joint_to_world of tracks at any time, as a viewer computes it: each track is interpolated between
// its own keys (rotations by slerp), then scales, rotations and translations are combined down the
// hierarchy. In double precision.
class TrackPoses {
 public:
  // Both must outlive it.
  TrackPoses(std::span<const int> parents, const JointTracks& tracks)
      : parents_(parents), tracks_(tracks) {}

  // At `frame`, which may be between two frames, from 0 to the number of frames - 1;
  // [joints]. Without frames the rest pose. Thread-safe.
  void at(double frame, std::span<Mat4> joint_to_world) const;

 private:
  std::span<const int> parents_;
  const JointTracks& tracks_;
};

}  // namespace krok::gltf
