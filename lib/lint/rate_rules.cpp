#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "lint/series_internal.h"
#include "math/window.h"
#include "roles/roles.h"

// frame-rate: repeated frames, and how long steps and falls take.

namespace krok::lint {

namespace {

// Seconds that a foot is faster than a fifth of its fastest speed, of legs of 0.86 m: the median of
// 66 public captures of walks and runs, nine tenths of which are within a third of it.
constexpr double kUsualSwing = 0.53;
// Fewer show a rate that is far off, by the square of the limit.
constexpr std::size_t kMinSwings = 4, kMinFarSwings = 2;
constexpr double kSwingSpeed = 0.2;    // of a foot's fastest speed; slower is a stance
constexpr double kShortestStep = 0.5;  // metres that a foot moves in a swing
constexpr double kLongestStep = 2.2;
constexpr double kDoubled = 0.18;  // of the frames that move

// Frames that repeat the one before, in a motion that moves on in the next.
void find_doubled(const Series& series, MotionFaults& out) {
  constexpr float kMovesOn = 1e-4F;
  int doubled = 0, moving = 0;
  for (int f = 1; f + 1 < series.frames; ++f) {
    const bool now = series.moved[at(f)] > kMovesOn, next = series.moved[at(f + 1)] > kMovesOn;
    if (!now && !next) continue;
    ++moving;
    doubled += series.moved[at(f)] < kStill && next ? 1 : 0;
  }
  if (moving < 10 || doubled < kDoubled * moving) return;
  Finding finding;
  finding.rule = Rule::frame_rate;
  finding.kind = "doubled";
  finding.last = series.frames - 1;
  finding.value = static_cast<double>(moving) / std::max(1, moving - doubled);
  finding.threshold = 1 / (1 - kDoubled);
  finding.detail = "frames for each one that moves";
  out.findings.push_back(finding);
}

// Seconds of the swings of one foot: while it is faster than a fifth of its fastest, which does not
// depend on the rate.
void add_swings(const Series& series, int foot, std::vector<double>& swings) {
  std::vector<double> speeds(at(series.frames), 0.0);
  const auto place = [&](int f) { return series.clip.frame_positions(f)[at(foot)]; };
  for (int f = 1; f + 1 < series.frames; ++f) {
    speeds[at(f)] = 0.5 * (place(f + 1) - place(f - 1)).norm();
  }
  std::vector<double> sorted = speeds;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 95 / 100);
  std::ranges::nth_element(sorted, high);
  const double limit = kSwingSpeed * *high;
  int first = -1;
  for (int f = 1; f < series.frames; ++f) {
    const bool fast = speeds[at(f)] > limit;
    if (fast && first < 0) first = f;
    if (fast || first < 0) continue;
    const double way = (place(f) - place(first - 1)).norm() / series.scale;
    if (first > 1 && way > kShortestStep && way < kLongestStep) {
      // Fractions of frames at both ends.
      const auto crossing = [&](int a, int b) {
        const double rise = std::abs(speeds[at(b)] - speeds[at(a)]);
        return rise > 0 ? std::abs(speeds[at(b)] - limit) / rise : 0.5;
      };
      swings.push_back((f - 1 - first + crossing(first - 1, first) + crossing(f, f - 1)) /
                       series.rate);
    }
    first = -1;
  }
}

void find_swings(const Series& series, MotionFaults& out) {
  std::vector<double> swings;
  for (const LegRoles& leg : kLegRoles) {
    const int foot = series.roles.joint(leg.foot);
    if (foot >= 0) add_swings(series, foot, swings);
  }
  if (swings.size() < kMinFarSwings) return;
  const double usual = kUsualSwing * std::sqrt(series.scale), swing = median(swings);
  const double limit = series.threshold(Rule::frame_rate), factor = swing / usual;
  const double allowed = swings.size() < kMinSwings ? limit * limit : limit;
  if (factor < allowed && factor > 1 / allowed) return;
  Finding finding;
  finding.rule = Rule::frame_rate;
  finding.kind = factor > 1 ? "slow" : "fast";
  finding.last = series.frames - 1;
  finding.value = factor, finding.threshold = limit;
  finding.detail =
      fmt::format("swings of {} s, people's take {} s", readable(swing, 2), readable(usual, 2));
  out.findings.push_back(finding);
}

}  // namespace

void find_rate_faults(const Series& series, MotionFaults& out) {
  if (!series.has(Rule::frame_rate)) return;
  const std::size_t before = out.findings.size();
  find_doubled(series, out);
  if (out.findings.size() == before && series.roles.humanoid) find_swings(series, out);
}

}  // namespace krok::lint
