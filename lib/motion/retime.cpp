#include "motion/retime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "motion/sample.h"

namespace krok {

Result<Clip> retime(const Clip& clip, double rate, double speed, LastFrame last) {
  if (!(speed > 0) || !std::isfinite(speed)) {
    return Error("motion-speed", fmt::format("a motion cannot be played {} times as fast", speed),
                 "the speed is a positive number; 2 is twice as fast");
  }
  // Played at another rate the same frames are faster; sampled at the old one they are new frames.
  Clip faster = clip;
  faster.rate = clip.rate * speed;
  if (!std::isfinite(faster.rate) || !(faster.rate > 0)) {
    return Error("motion-speed",
                 fmt::format("a speed of {} is beyond what can be reckoned with", speed));
  }
  const double steps = faster.duration() * rate;
  if (last == LastFrame::kept && steps > 0 && steps < 1e9 && std::isfinite(rate)) {
    // Whole steps from end to end: the rate that makes them so stands in for the one asked for.
    const double whole = std::max(1.0, std::round(steps));
    faster.rate = (clip.frame_count() - 1) * rate / whole;
  }
  return resample(faster, rate);
}

}  // namespace krok
