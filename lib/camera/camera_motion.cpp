#include "camera/camera_motion.h"

#include <algorithm>

#include "math/quaternion.h"

namespace krok {

CameraMotion camera_motion(const CameraTrack& track) {
  CameraMotion motion;
  if (track.frame_count() == 0) return motion;
  const auto [least, most] = std::ranges::minmax(track.fields_of_view);
  motion.least_field_of_view = static_cast<double>(least);
  motion.most_field_of_view = static_cast<double>(most);
  for (int frame = 0; frame + 1 < track.frame_count(); ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    const double way = (track.positions[f + 1] - track.positions[f]).cast<double>().norm();
    const double turn = angle_between(track.orientations[f].cast<double>(),
                                      track.orientations[f + 1].cast<double>());
    motion.length += way;
    if (way * track.rate > motion.largest_speed) {
      motion.largest_speed = way * track.rate;
      motion.fastest_frame = frame;
    }
    if (turn * track.rate > motion.largest_turning) {
      motion.largest_turning = turn * track.rate;
      motion.fastest_turning_frame = frame;
    }
  }
  return motion;
}

}  // namespace krok
