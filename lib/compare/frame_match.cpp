#include "compare/frame_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace krok::compare {

namespace {

constexpr double kSameRate = 1e-6;    // relative
constexpr double kSameMoment = 1e-3;  // of the frame time

std::vector<std::pair<int, int>> frames_at_common_times(int first_frames, double first_rate,
                                                        int second_frames, double second_rate) {
  std::vector<std::pair<int, int>> frames;
  const double allowed = kSameMoment * std::min(1.0, second_rate / first_rate);
  for (int i = 0; i < first_frames; ++i) {
    const double in_second = i / first_rate * second_rate;
    const double nearest = std::round(in_second);
    if (nearest >= second_frames) break;
    if (std::abs(in_second - nearest) <= allowed) frames.emplace_back(i, static_cast<int>(nearest));
  }
  return frames;
}

}  // namespace

FrameMatch match_frames(int first_frames, double first_rate, int second_frames, double second_rate,
                        double same_time) {
  FrameMatch match;
  const int last = std::min(first_frames, second_frames) - 1;
  const bool same_rate =
      std::abs(first_rate - second_rate) <= kSameRate * first_rate ||
      (last > 0 && std::abs(last / first_rate - last / second_rate) <= same_time);
  if (!same_rate) {
    match.differences.push_back(fmt::format("{} frames/s in the first, {} in the second",
                                            readable(first_rate), readable(second_rate)));
  }
  if (first_frames != second_frames) {
    match.differences.push_back(
        fmt::format("{} frames in the first, {} in the second", first_frames, second_frames));
  }
  if (same_rate || first_frames == second_frames) {
    for (int i = 0; i < std::min(first_frames, second_frames); ++i) match.frames.emplace_back(i, i);
  } else {
    match.frames = frames_at_common_times(first_frames, first_rate, second_frames, second_rate);
  }
  return match;
}

}  // namespace krok::compare
