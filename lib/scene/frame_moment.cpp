#include "scene/frame_moment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers.h"

namespace krok {

FrameMoment frame_moment(double time, double rate, int frames) {
  const int last = frames - 1;
  const double wanted = time * rate;
  if (!(wanted > 0)) return {};  // NaN gives the first frame
  if (wanted >= last) return {last, 0};
  const int before = static_cast<int>(wanted);
  const double fraction = wanted - before;
  // Times that match a frame up to rounding give that frame, without interpolation.
  constexpr double kSameFrame = 1e-9;
  if (fraction < kSameFrame) return {before, 0};
  if (fraction > 1.0 - kSameFrame) return {before + 1, 0};
  return {before, fraction};
}

Status check_frame_rate(double rate, std::string code) {
  if (rate >= kMinRate && rate <= kMaxRate) return {};
  return Error(std::move(code),
               fmt::format("the frame rate is {}, expected {} to {} frames per second",
                           readable(rate), readable(kMinRate), readable(kMaxRate)));
}

Result<int> frames_within(double duration, double rate, int joints) {
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  const double frames = std::floor(duration * rate + 1e-3) + 1;
  if (!(frames * std::max(joints, 1) <= 1e8)) {
    return Error("clip-too-long", fmt::format("{} fps over {} s gives {} frames, too many to hold",
                                              rate, duration, frames));
  }
  return static_cast<int>(frames);
}

}  // namespace krok
