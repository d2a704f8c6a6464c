#include "motion/retime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "motion/sample.h"

namespace krok {

Result<Clip> retime(const Clip& clip, double rate, double speed, LastFrame last) {
  const auto made = retime(frames_of(clip), rate, speed, last);
  if (!made) return made.error();
  auto result = load(*made, 1);
  if (result) result->provenance = clip.provenance;
  return result;
}

Result<FrameSource> retime(const FrameSource& source, double rate, double speed, LastFrame last) {
  if (!(speed > 0) || !std::isfinite(speed)) {
    return Error("motion-speed", fmt::format("invalid speed {}", speed),
                 "the speed must be a positive number; 2 is twice as fast");
  }
  // Raising the rate speeds the frames up; resampling then restores the requested rate.
  FrameSource faster = source;
  faster.rate = source.rate * speed;
  if (!std::isfinite(faster.rate) || !(faster.rate > 0)) {
    return Error("motion-speed", fmt::format("a speed of {} is out of range", speed));
  }
  const double steps = faster.duration() * rate;
  if (last == LastFrame::kept && steps > 0 && steps < 1e9 && std::isfinite(rate)) {
    // Adjusts the speed so that a whole number of frames spans the motion.
    const double whole = std::max(1.0, std::round(steps));
    faster.rate = (source.frame_count - 1) * rate / whole;
  }
  return resample(faster, rate);
}

}  // namespace krok
