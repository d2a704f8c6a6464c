#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "compare/scene_comparison_internal.h"
#include "core/numbers.h"

namespace krok::compare {

namespace {

constexpr std::size_t kMaxMoments = 1'000'000;
constexpr double kRounding = 1e-4;  // seconds
constexpr int kParts = 4;           // from key to key, where an animation is not straight there

using Times = std::vector<std::pair<double, double>>;  // of the first, of the second

// Key times of both, for as long as both last, rising. Times that differ by at most `same` are one
// moment; each scene uses its own time.
Times common_times(const std::vector<double>& first, const std::vector<double>& second,
                   double same) {
  Times times;
  const double begin = std::max(first.front(), second.front()) - same;
  const double end = std::min(first.back(), second.back()) + same;
  const double infinite = std::numeric_limits<double>::infinity();
  const auto add = [&](double a, double b) {
    if (std::max(a, b) < begin || std::min(a, b) > end) return;
    // Skips keys of several channels that differ only by rounding.
    if (!times.empty() && a - times.back().first <= kRounding) return;
    times.emplace_back(a, b);
  };
  std::size_t i = 0, j = 0;
  const auto at = [&](const std::vector<double>& list, std::size_t k) {
    return k < list.size() ? list[k] : infinite;
  };
  while (i < first.size() || j < second.size()) {
    const double a = at(first, i);
    const double b = at(second, j);
    const double apart = std::abs(a - b);
    // The next key of the earlier one may be nearer.
    const double other = a < b ? std::abs(at(first, i + 1) - b) : std::abs(at(second, j + 1) - a);
    if (apart <= same && apart <= other) {
      add(a, b);
      ++i, ++j;
    } else {
      add(std::min(a, b), std::min(a, b));
      a < b ? ++i : ++j;
    }
  }
  return times;
}

// Steps and splines may agree at all keys and differ between them: moments up to the next key.
void add_between(SceneComparison& comparison, double first_time, double second_time) {
  const Moment last = comparison.moments.back();
  if (first_time - last.first_time < kParts * kRounding) return;
  for (int part = 1; part < kParts; ++part) {
    const double share = static_cast<double>(part) / kParts;
    Moment moment = last;
    moment.first_time += share * (first_time - last.first_time);
    moment.second_time += share * (second_time - last.second_time);
    comparison.moments.push_back(moment);
  }
}

Status add_moments(SceneComparison& comparison, int first_animation, int second_animation) {
  const Scene::Animation& a =
      comparison.first.animations[static_cast<std::size_t>(first_animation)];
  const Scene::Animation& b =
      comparison.second.animations[static_cast<std::size_t>(second_animation)];
  const std::string name = label("animation", a.name, first_animation);
  const double same = comparison.options.tolerance.time;
  if (a.key_times.empty() || b.key_times.empty()) {
    if (a.key_times.empty() != b.key_times.empty()) {
      comparison.say(
          fmt::format("{}: only the {} has keys", name, a.key_times.empty() ? "second" : "first"));
    }
    return {};
  }
  const std::size_t each = a.straight && b.straight ? 1 : kParts;
  if (each * (a.key_times.size() + b.key_times.size()) + comparison.moments.size() > kMaxMoments) {
    return Error("compare-too-long", fmt::format("{} has more than a million key times", name));
  }
  if (std::abs(a.key_times.back() - b.key_times.back()) > same ||
      std::abs(a.key_times.front() - b.key_times.front()) > same) {
    comparison.say(
        fmt::format("{}: {} s to {} s in the first, {} s to {} s in the second; only the common "
                    "range is compared",
                    name, readable(a.key_times.front()), readable(a.key_times.back()),
                    readable(b.key_times.front()), readable(b.key_times.back())));
  }

  if (a.straight != b.straight) {
    comparison.note(fmt::format("{}: only the {} has steps or splines between keys", name,
                                a.straight ? "second" : "first"));
  }
  int frame = 0;
  for (const auto& [first_time, second_time] : common_times(a.key_times, b.key_times, same)) {
    if (frame > 0 && !(a.straight && b.straight)) add_between(comparison, first_time, second_time);
    comparison.moments.push_back(
        {first_animation, second_animation, frame, first_time, second_time});
    ValueLocation place{.animation = comparison.first.animations.size() > 1 ? first_animation : -1,
                        .frame = frame++,
                        .time = first_time};
    comparison.result.times.add(std::abs(first_time - second_time), place);
  }
  const auto frames = static_cast<std::size_t>(frame);
  if (frames > a.key_times.size() || frames > b.key_times.size()) {
    comparison.note(
        fmt::format("{}: {} key times in the first, {} in the second; compared at {} common times",
                    name, a.key_times.size(), b.key_times.size(), frames));
  }
  return {};
}

}  // namespace

Status choose_moments(SceneComparison& comparison) {
  const auto& first = comparison.first.animations;
  const auto& second = comparison.second.animations;
  if (comparison.first.only_still != comparison.second.only_still) {
    comparison.moments.push_back({});
    if (first.empty() && second.empty()) return {};
    comparison.note(fmt::format("only the {} can be animated, so only the static pose is compared",
                                comparison.first.only_still ? "second" : "first"));
    return {};
  }
  if (first.size() != second.size()) {
    comparison.say(fmt::format("{} in the first, {} in the second",
                               counted(static_cast<long long>(first.size()), "animation"),
                               second.size()));
  }
  for (const auto& [i, j] :
       match_lists(names_of(first), names_of(second), Matching::automatic).pairs) {
    if (auto added = add_moments(comparison, i, j); !added) return added;
  }
  if (comparison.moments.empty()) comparison.moments.push_back({});
  return {};
}

}  // namespace krok::compare
