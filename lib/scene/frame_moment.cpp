#include "scene/frame_moment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

Result<int> frames_within(double duration, double rate, int joints) {
  if (!std::isfinite(rate) || rate <= 0) {
    return Error("clip-rate", fmt::format("a rate of {} fps is not positive", rate));
  }
  const double frames = std::floor(duration * rate + 1e-3) + 1;
  if (!(frames * std::max(joints, 1) <= 1e8)) {
    return Error("clip-too-long", fmt::format("{} fps over {} s gives {} frames, too many to hold",
                                              rate, duration, frames));
  }
  return static_cast<int>(frames);
}

}  // namespace krok
