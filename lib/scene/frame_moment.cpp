#include "scene/frame_moment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace krok {

FrameMoment frame_moment(double time, double rate, int frames) {
  const int last = frames - 1;
  const double wanted = time * rate;
  if (!(wanted > 0)) return {};  // not a number counts as the beginning
  if (wanted >= last) return {last, 0};
  const int before = static_cast<int>(wanted);
  const double fraction = wanted - before;
  // Times that are a frame's own up to rounding give that frame, not a mixture.
  constexpr double kSameFrame = 1e-9;
  if (fraction < kSameFrame) return {before, 0};
  if (fraction > 1.0 - kSameFrame) return {before + 1, 0};
  return {before, fraction};
}

Result<int> frames_within(double duration, double rate, int joints) {
  if (!std::isfinite(rate) || rate <= 0) {
    return Error("clip-rate", fmt::format("a rate of {} frames a second is not positive", rate));
  }
  const double frames = std::floor(duration * rate + 1e-3) + 1;
  if (!(frames * std::max(joints, 1) <= 1e8)) {
    return Error("clip-too-long", fmt::format("{} frames a second over {} s make {} frames", rate,
                                              duration, frames));
  }
  return static_cast<int>(frames);
}

}  // namespace krok
