#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/index.h"
#include "core/numbers.h"
#include "lint/series_internal.h"
#include "math/window.h"
#include "roles/body_frame.h"
#include "roles/roles.h"

// frame-rate: repeated frames, how long swings take, and how fast runs fall.

namespace krok::lint {

namespace {

// Seconds that a foot is faster than a fifth of its fastest speed, of legs of 0.86 m: the median of
// 259 public captures of walks and runs, nine tenths of which are within a third of it.
constexpr double kUsualSwing = 0.56;
constexpr std::size_t kMinSwings = 2, kMinFlights = 2;
constexpr double kSwingSpeed = 0.2;    // of a foot's fastest speed; slower is a stance
constexpr double kShortestStep = 0.5;  // metres that a foot moves in a swing
constexpr double kLongestStep = 5;
constexpr double kSameWay = 0.5;    // cosine between the ways of steps of a gait
constexpr float kHipsGo = 0.5F;     // of the steps' length
constexpr double kMinRate = 10;     // frames per second; less do not show how long a swing lasts
constexpr double kNextSwing = 2.5;  // times a swing's duration, from it to the other foot's
// Hips fall a little faster than bodies: arms and legs fall slower. Median of 59 captured runs.
constexpr double kFall = 10.8;      // metres per second squared
constexpr double kFlying = 0.2;     // of the time that a foot swings, in a run
constexpr double kSlowestFall = 1;  // metres per second squared; slower is no flight
constexpr double kSpread = 0.37;    // of a median; 98 % of captured walks and runs are within 0.2
constexpr double kDoubled = 0.18;   // of the frames that move

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
  Finding finding =
      finding_of(Rule::frame_rate, series,
                 static_cast<double>(moving) / std::max(1, moving - doubled), series.whole());
  finding.kind = "doubled";
  finding.threshold = 1 / (1 - kDoubled);
  finding.detail = "frames for each one that moves";
  out.findings.push_back(finding);
}

// Frames [first, end) in which a foot is faster than a fifth of its fastest, which does not depend
// on the rate.
struct Swing {
  int first = 0, end = 0;
  double seconds = 0;
  Vec3f way = Vec3f::Zero();  // of the foot, level
};

std::vector<Swing> swings_of(const Series& series, Role role) {
  const int foot = series.roles.joint(role);
  std::vector<Swing> swings;
  if (foot < 0) return swings;
  std::vector<double> speeds(at(series.frames), 0.0);
  const auto place = [&](int f) { return series.clip.frame_positions(f)[at(foot)]; };
  const auto is_below_hips = [&](int f) {  // not of cartwheels
    return place(f).y() < series.clip.frame_positions(f)[at(series.carrier)].y();
  };
  for (int f = 1; f + 1 < series.frames; ++f) {
    speeds[at(f)] = 0.5 * (place(f + 1) - place(f - 1)).norm();
  }
  // Of the frames in which it moves, as takes may stand for most of their time.
  std::vector<double> sorted = speeds;
  const auto high_of = [&](std::size_t percent) {
    const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * percent / 100);
    std::ranges::nth_element(sorted, high);
    return *high;
  };
  const double usual = high_of(95);
  std::erase_if(sorted, [&](double speed) { return speed < 0.1 * usual; });
  const double limit = kSwingSpeed * high_of(91);
  const auto is_fast = [&](int f) { return speeds[at(f)] > limit; };
  for (const auto& [first, end] : runs_of(series.frames, is_fast)) {
    Vec3f moved = place(end) - place(first - 1);
    const double way = moved.norm() / series.scale;
    moved.y() = 0;
    if (first < 2 || way <= kShortestStep || way >= kLongestStep ||
        !is_below_hips((first + end) / 2)) {
      continue;
    }
    // Fractions of frames at both ends.
    const auto crossing = [&](int a, int b) {
      const double rise = std::abs(speeds[at(b)] - speeds[at(a)]);
      return rise > 0 ? std::abs(speeds[at(b)] - limit) / rise : 0.5;
    };
    const double part = crossing(first - 1, first) + crossing(end, end - 1);
    swings.push_back({first, end, (end - 1 - first + part) / series.rate, moved});
  }
  return swings;
}

// Swings as in a gait, feet in turns and each the way of the one before and the one after, which
// the hips go, too; nothing where most are otherwise, as in fights and dances.
std::vector<double> gait_swings(const Series& series, const std::vector<Swing>& left,
                                const std::vector<Swing>& right) {
  std::vector<std::pair<Swing, bool>> all;  // and whether it is the right foot's
  for (const Swing& swing : left) all.emplace_back(swing, false);
  for (const Swing& swing : right) all.emplace_back(swing, true);
  std::ranges::sort(all, {}, [](const auto& one) { return one.first.first; });
  const auto hips = [&](int f) { return series.clip.frame_positions(f)[at(series.carrier)]; };
  const auto follows = [&](std::size_t i) {
    const auto& [a, a_right] = all[i];
    const auto& [b, b_right] = all[i + 1];
    const Vec3f way = 0.5F * (a.way + b.way);
    const bool travels = way.dot(hips(b.end) - hips(a.first)) > kHipsGo * way.squaredNorm();
    return travels && a_right != b_right && b.first - a.first < kNextSwing * (a.end - a.first) &&
           a.way.dot(b.way) > kSameWay * a.way.norm() * b.way.norm();
  };
  std::vector<double> seconds;
  for (std::size_t i = 0; i < all.size() && all.size() > 1; ++i) {
    if ((i == 0 || follows(i - 1)) && (i + 1 == all.size() || follows(i))) {
      seconds.push_back(all[i].first.seconds);
    }
  }
  if (2 * seconds.size() < all.size()) seconds.clear();
  return seconds;
}

// How fast the hips fall while both feet swing, as in runs; nothing of walks.
std::vector<double> falls_of(const Series& series, const std::vector<Swing>& left,
                             const std::vector<Swing>& right) {
  std::vector<double> falls;
  int flying = 0, swinging = 0;
  for (const auto* swings : {&left, &right}) {
    for (const Swing& swing : *swings) swinging += swing.end - swing.first;
  }
  for (auto a = left.begin(), b = right.begin(); a != left.end() && b != right.end();) {
    const int first = std::max(a->first, b->first), end = std::min(a->end, b->end);
    if (end - first >= 3) {
      falls.push_back(series.fall(first, end - 1));
      flying += end - first;
    }
    a->end < b->end ? ++a : ++b;
  }
  if (2 * flying < kFlying * swinging) falls.clear();
  return falls;
}

// The median of swings or falls that are as regular as those of a gait, half of them within
// kSpread; nothing of a dance.
std::optional<double> regular_median(std::vector<double> values) {
  const double middle = median(values);
  for (double& value : values) value = std::abs(value - middle);
  if (median(std::move(values)) > kSpread * middle) return std::nullopt;
  return middle;
}

// Whether legs are as long for the body as people's: people's motion on a toy's legs keeps people's
// time, and its own motion has none of ours.
bool has_proportions_of_people(const Series& series) {
  constexpr double kUncertain = 0.35;  // of the stature; a quarter in public captures
  const auto stature = stature_of(series.clip.skeleton, series.roles);
  return !stature || stature->uncertainty < kUncertain * stature->metres;
}

// Runs by how fast they fall, and walks by how long their swings take.
void find_speed(const Series& series, MotionFaults& out) {
  if (series.rate < kMinRate || !has_proportions_of_people(series)) return;
  const auto left = swings_of(series, Role::left_foot), right = swings_of(series, Role::right_foot);
  const std::vector<double> seconds = gait_swings(series, left, right);
  if (seconds.size() < kMinSwings) return;
  const auto falls = falls_of(series, left, right);
  const bool runs = !falls.empty();
  if (runs && falls.size() < kMinFlights) return;  // a single cycle of a run
  const auto found = regular_median(runs ? falls : seconds);
  if (!found || (runs && *found < kSlowestFall)) return;
  const double usual = kUsualSwing * std::sqrt(series.scale);
  const double limit = series.threshold(Rule::frame_rate);
  const double factor = runs ? std::sqrt(kFall / *found) : *found / usual;
  if (factor < limit && factor > 1 / limit) return;
  Finding finding = finding_of(Rule::frame_rate, series, factor, series.whole());
  finding.kind = factor > 1 ? "slow" : "fast";
  finding.detail = runs ? fmt::format("falls with {} m/s2 in a run, people do with {} m/s2",
                                      readable(*found, 2), readable(kFall, 3))
                        : fmt::format("swings of {} s, people's take {} s", readable(*found, 2),
                                      readable(usual, 2));
  out.findings.push_back(finding);
}

}  // namespace

void find_rate_faults(const Series& series, MotionFaults& out) {
  if (!series.has(Rule::frame_rate)) return;
  const std::size_t before = out.findings.size();
  find_doubled(series, out);
  if (out.findings.size() == before && series.roles.humanoid) find_speed(series, out);
}

}  // namespace krok::lint
