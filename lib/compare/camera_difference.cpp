#include "compare/camera_difference.h"

#include <fmt/format.h>

#include <cmath>

#include "compare/frame_match.h"
#include "math/quaternion.h"

namespace krok::compare {

Result<CameraDifference> difference(const CameraTrack& first, const CameraTrack& second,
                                    const Tolerance& tolerance) {
  for (const CameraTrack* camera : {&first, &second}) {
    if (auto ok = check(*camera); !ok) {
      Error error = ok.error();
      error.message =
          fmt::format("the {} camera: {}", camera == &first ? "first" : "second", error.message);
      return error;
    }
  }
  CameraDifference result;
  result.positions = Measure(tolerance.length);
  result.orientations = result.fields_of_view = Measure(tolerance.angle);

  FrameMatch frames =
      match_frames(first.frame_count(), first.rate, second.frame_count(), second.rate);
  result.structure = std::move(frames.differences);
  result.compared_frames = static_cast<int>(frames.frames.size());
  for (const auto& [frame_a, frame_b] : frames.frames) {
    const auto i = static_cast<std::size_t>(frame_a);
    const auto j = static_cast<std::size_t>(frame_b);
    const ValueLocation place{.frame = frame_a, .time = frame_a / first.rate};
    const Vec3 apart = first.positions[i].cast<double>() - second.positions[j].cast<double>();
    result.positions.add(apart.norm(), place);
    result.orientations.add(
        angle_between(first.orientations[i].cast<double>(), second.orientations[j].cast<double>()),
        place);
    result.fields_of_view.add(std::abs(static_cast<double>(first.fields_of_view[i]) -
                                       static_cast<double>(second.fields_of_view[j])),
                              place);
  }
  return result;
}

}  // namespace krok::compare
