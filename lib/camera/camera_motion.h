#pragma once

#include "scene/camera_track.h"

namespace krok {

// Metrics of a camera's motion between frames.
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
