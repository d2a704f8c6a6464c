#pragma once

#include "scene/camera_track.h"

namespace krok {

// How a camera moves, from frame to frame.
struct CameraMotion {
  double length = 0;           // metres of its way
  double largest_speed = 0;    // metres a second
  int fastest_frame = 0;       // from that frame to the next
  double largest_turning = 0;  // radians a second, whatever the axis
  int fastest_turning_frame = 0;
  double least_field_of_view = 0, most_field_of_view = 0;  // vertical, radians
};

// Of a track that passes check(); zeros for one without frames.
CameraMotion camera_motion(const CameraTrack& track);

}  // namespace krok
