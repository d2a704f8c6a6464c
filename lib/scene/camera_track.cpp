#include "scene/camera_track.h"
#include "math/quaternion.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

#include <fmt/format.h>

#include <cmath>

namespace krok {

Status check(const CameraTrack& camera) {
  const std::size_t count = camera.positions.size();
  if (camera.orientations.size() != count || camera.fields_of_view.size() != count) {
    return Error("camera-shape", "positions, orientations and fields of view differ in length");
  }
  if (Status status = check_frame_rate(camera.rate, "camera-rate"); !status) return status;
  for (std::size_t i = 0; i < count; ++i) {
    const float view = camera.fields_of_view[i];
    if (!is_near(camera.positions[i]) || !camera.orientations[i].coeffs().allFinite() ||
        std::abs(camera.orientations[i].norm() - 1.0f) > 1e-3f) {
      return Error("camera-value",
                   fmt::format("frame {} is not finite, over 1e9 m away or not a rotation", i));
    }
    if (!(view > 0) || !(view < static_cast<float>(kPi))) {
      return Error(
          "camera-value",
          fmt::format("the field of view in frame {} is {} rad, expected 0 to pi", i, view));
    }
  }
  int before = 0;
  for (const int cut : camera.cuts) {
    if (cut <= before || cut >= camera.frame_count()) {
      return Error("camera-cut",
                   fmt::format("a cut is at frame {}, expected more than {} and less than {}", cut,
                               before, camera.frame_count()));
    }
    before = cut;
  }
  return {};
}

CameraMotion camera_motion(const CameraTrack& track) {
  CameraMotion motion;
  if (track.frame_count() == 0) return motion;
  const auto [least, most] = std::ranges::minmax(track.fields_of_view);
  motion.least_field_of_view = static_cast<double>(least);
  motion.most_field_of_view = static_cast<double>(most);
  for (int frame = 0; frame + 1 < track.frame_count(); ++frame) {
    if (track.is_cut(frame + 1)) continue;
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
