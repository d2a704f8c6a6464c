#include "contacts/step_measures.h"

#include <algorithm>
#include <cmath>

#include "contacts/gait_metrics.h"
#include "math/window.h"
#include "motion/travel.h"

namespace krok {

namespace {

constexpr double kLongestStep = 3;  // seconds, from a place to the next
constexpr double kNoWay = 0.01;     // metres; a shorter stride has no direction
constexpr double kAlike = 0.5;      // of the longer of two strides, and of the hips' way

struct FootPlace {
  std::size_t side = 0;       // FootSide
  double begin = 0, end = 0;  // seconds, of the part of the stance that it is the mean of
  double time = 0;            // seconds, its middle
  Vec3 place = Vec3::Zero();
};

Vec3 mean_position(const Clip& clip, int joint, double from, double to) {
  const int last = clip.frame_count() - 1;
  const int first = std::clamp(static_cast<int>(std::lround(from * clip.rate)), 0, last);
  const int end = std::clamp(static_cast<int>(std::lround(to * clip.rate)), first, last);
  Vec3 sum = Vec3::Zero();
  for (int f = first; f <= end; ++f) {
    sum += clip.frame_positions(f)[static_cast<std::size_t>(joint)].cast<double>();
  }
  return sum / (end - first + 1);
}

// The stances that the clip's ends cut off, if their middle third is within it: the rest is taken
// to last as long as whole ones do.
std::vector<StanceTimes> cut_stances(const std::vector<Keytime>& keytimes, FootSide side,
                                     double duration) {
  std::vector<double> lengths;
  for (const FootSide foot : {FootSide::left, FootSide::right}) {
    for (const StanceTimes& stance : stance_times(keytimes, foot)) {
      lengths.push_back(stance.off - stance.strike);
    }
  }
  std::vector<StanceTimes> cut;
  if (lengths.empty()) return cut;
  const double usual = upper_median(lengths);
  const Keytime *first = nullptr, *last = nullptr;
  for (const Keytime& key : keytimes) {
    if (!key.name.starts_with(name_of(side))) continue;
    if (first == nullptr) first = &key;
    last = &key;
  }
  if (first == nullptr) return cut;
  if (first->name.ends_with("_off") && first->time > 2 * usual / 3) {
    cut.push_back({first->time - usual, first->time});
  }
  if (last->name.ends_with("_strike") && duration - last->time > 2 * usual / 3) {
    cut.push_back({last->time, last->time + usual});
  }
  return cut;
}

std::vector<FootPlace> places_of(const Clip& clip, const std::array<int, 2>& ankles,
                                 const std::vector<Keytime>& keytimes, bool with_cut) {
  std::vector<FootPlace> places;
  for (const std::size_t side : {0, 1}) {
    const auto foot = static_cast<FootSide>(side);
    std::vector<StanceTimes> stances = stance_times(keytimes, foot);
    if (with_cut) {
      const auto cut = cut_stances(keytimes, foot, clip.duration());
      stances.insert(stances.end(), cut.begin(), cut.end());
    }
    for (const StanceTimes& stance : stances) {
      const double third = (stance.off - stance.strike) / 3;
      places.push_back(
          {side, stance.strike + third, stance.off - third, 0.5 * (stance.strike + stance.off),
           mean_position(clip, ankles[side], stance.strike + third, stance.off - third)});
    }
  }
  std::ranges::stable_sort(places, {}, &FootPlace::time);
  return places;
}

std::optional<double> median_if_any(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(upper_median(values));
}

// Whose steps there are.
using Sides = std::array<bool, 2>;

StepMeasures measures_of(const Clip& clip, const RoleMap& roles,
                         const std::vector<Keytime>& keytimes, bool with_cut, Sides& sides) {
  StepMeasures measures;
  const std::array<int, 2> ankles = {roles.joint(Role::left_foot), roles.joint(Role::right_foot)};
  if (ankles[0] < 0 || ankles[1] < 0 || clip.frame_count() == 0) return measures;
  const std::vector<FootPlace> places = places_of(clip, ankles, keytimes, with_cut);
  std::vector<double> speeds, strides, widths;
  int pairs = 0, alike = 0;
  Vec3 before = Vec3::Zero();  // the stride of the step before
  bool follows = false;
  const int hips = roles.joint(Role::hips);
  const std::array<int, 2> thighs = {roles.joint(Role::left_upper_leg),
                                     roles.joint(Role::right_upper_leg)};
  std::array<std::vector<double>, 2> lengths;
  // No stride leads across a jump of the hips, as where a path goes back to its start.
  const std::vector<Jump> jumps = hips < 0 ? std::vector<Jump>() : jumps_of(clip, hips);
  const auto jumps_within = [&](double from, double to) {
    return std::ranges::any_of(jumps, [&](const Jump& jump) {
      return jump.frame > from * clip.rate && jump.frame <= to * clip.rate + 1;
    });
  };
  for (std::size_t i = 0; i + 2 < places.size(); ++i) {
    const FootPlace &first = places[i], &between = places[i + 1], &next = places[i + 2];
    if (first.side == between.side || first.side != next.side ||
        between.time - first.time > kLongestStep || next.time - between.time > kLongestStep ||
        jumps_within(first.begin, next.end)) {
      follows = false;
      continue;
    }
    const Vec3 stride(next.place.x() - first.place.x(), 0, next.place.z() - first.place.z());
    const double length = stride.norm();
    ++measures.steps;
    sides[between.side] = true;
    if (follows) {
      ++pairs;
      const double longer = std::max(stride.squaredNorm(), before.squaredNorm());
      const Vec3 carried = hips < 0 ? stride
                                    : mean_position(clip, hips, next.time, next.time) -
                                          mean_position(clip, hips, first.time, first.time);
      const bool goes_on = stride.dot(before) > kAlike * longer;
      alike += goes_on && stride.dot(carried) > kAlike * stride.squaredNorm() ? 1 : 0;
    }
    before = stride;
    follows = true;
    strides.push_back(length);
    speeds.push_back(length / (next.time - first.time));
    if (length < kNoWay) continue;
    const Vec3 ahead = stride / length, across = Vec3::UnitY().cross(ahead);  // to the left
    const Vec3 step = between.place - first.place;
    lengths[between.side].push_back(step.dot(ahead));
    // Who walks backwards has the left foot on the right of the way.
    bool backwards = false;
    if (thighs[0] >= 0 && thighs[1] >= 0) {
      const Vec3 left = mean_position(clip, thighs[0], first.time, next.time) -
                        mean_position(clip, thighs[1], first.time, next.time);
      backwards = left.dot(across) < -kAlike * left.norm();
    }
    widths.push_back(step.dot(across) * ((between.side == 0) != backwards ? 1 : -1));
  }
  measures.speed = median_if_any(speeds);
  measures.stride_length = median_if_any(strides);
  measures.step_length = {median_if_any(lengths[0]), median_if_any(lengths[1])};
  measures.step_width = median_if_any(widths);
  if (pairs > 0) measures.steadiness = static_cast<double>(alike) / pairs;
  return measures;
}

}  // namespace

StepMeasures step_measures(const Clip& clip, const RoleMap& roles,
                           const std::vector<Keytime>& keytimes) {
  Sides sides = {};
  const StepMeasures whole = measures_of(clip, roles, keytimes, false, sides);
  return sides[0] && sides[1] ? whole : measures_of(clip, roles, keytimes, true, sides);
}

}  // namespace krok
