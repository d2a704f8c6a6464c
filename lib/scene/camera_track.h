#pragma once

#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "scene/provenance.h"

namespace krok {

// A camera over time, in Krok's coordinate frame. As in glTF the camera looks along its local -Z
// with +Y up. Arrays have [frames] elements; frame i is at time i / rate.
struct CameraTrack {
  double rate = 30.0;
  std::vector<Vec3f> positions;       // metres
  std::vector<Quatf> orientations;    // camera_to_world, unit
  std::vector<float> fields_of_view;  // vertical, radians, in (0, pi)
  Provenance provenance;

  int frame_count() const { return static_cast<int>(positions.size()); }
};

// Checks everything documented above. Codes: camera-shape, camera-rate, camera-value.
Status check(const CameraTrack& camera);

}  // namespace krok
