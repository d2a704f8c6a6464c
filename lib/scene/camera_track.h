#pragma once

#include <algorithm>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/provenance.h"

namespace krok {

// A camera over time, in Krok's coordinate frame. As in glTF the camera looks along its local -Z
// with +Y up. Arrays have [frames] elements; frame i is at time i / rate.
struct CameraTrack {
  double rate = 30.0;
  std::vector<Vec3f> positions;       // metres
  std::vector<Quatf> orientations;    // camera_to_world, unit
  std::vector<float> fields_of_view;  // vertical, radians, in (0, pi)
  // Frames at which a new shot begins: the frame before holds until then, nothing is interpolated.
  // They increase and are at least 1.
  std::vector<int> cuts;
  Provenance provenance;

  int frame_count() const { return static_cast<int>(positions.size()); }
  bool is_cut(int frame) const { return std::ranges::binary_search(cuts, frame); }
};

// Checks everything documented above. Codes: camera-shape, camera-rate, camera-value,
// camera-cut.
Status check(const CameraTrack& camera);

// Metrics of a camera's motion between frames; a cut is none.
struct CameraMotion {
  double length = 0;           // path length, metres
  double largest_speed = 0;    // metres per second
  int fastest_frame = 0;       // the first of the two frames
  double largest_turning = 0;  // radians per second, about any axis
  int fastest_turning_frame = 0;
  double least_field_of_view = 0, most_field_of_view = 0;  // vertical, radians
};

// For a track that passes check(); zeros for one without frames.
CameraMotion camera_motion(const CameraTrack& track);

}  // namespace krok
