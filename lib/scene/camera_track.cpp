#include "scene/camera_track.h"
#include "scene/farthest.h"
#include "scene/frame_moment.h"

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
  return {};
}

}  // namespace krok
