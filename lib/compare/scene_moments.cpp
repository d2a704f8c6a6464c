#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "compare/scene_comparison_internal.h"
#include "core/index.h"
#include "core/numbers.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

constexpr std::size_t kMaxMoments = 1'000'000;
constexpr double kRounding = 1e-4;    // seconds
constexpr double kBeforeStep = 1e-6;  // of a gap: the time before its end that still shows it

struct CommonTime {
  double first = 0, second = 0;  // in seconds of each
  int key = -1;                  // the first's key that it is, or -1
};
using Times = std::vector<CommonTime>;

// Key times of both, from the first of all, before whose key the other shows its first pose, for as
// long as both last, rising. Times that differ by at most `same` are one
// moment; each scene uses its own time.
Times common_times(const std::vector<double>& first, const std::vector<double>& second,
                   double same) {
  Times times;
  const double end = std::min(first.back(), second.back()) + same;
  const double infinite = std::numeric_limits<double>::infinity();
  const auto add = [&](double a, double b, int key) {
    if (std::min(a, b) > end) return;
    // Skips keys of several channels that differ only by rounding.
    if (!times.empty() && a - times.back().first <= kRounding) return;
    times.push_back({a, b, key});
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
      add(a, b, static_cast<int>(i));
      ++i, ++j;
    } else {
      add(std::min(a, b), std::min(a, b), a < b ? static_cast<int>(i) : -1);
      a < b ? ++i : ++j;
    }
  }
  return times;
}

// The gap of an animation that holds all times from `begin` to `end`, which no key divides.
KeyGap gap_between(const Scene::Animation& animation, double begin, double end) {
  const auto& keys = animation.key_times;
  const double middle = 0.5 * (begin + end);
  const auto after = std::upper_bound(keys.begin(), keys.end(), middle);
  if (animation.gaps.empty() || after == keys.begin() || after == keys.end()) return {};
  KeyGap gap = animation.gaps[static_cast<std::size_t>(after - keys.begin()) - 1];
  gap.jumps = gap.jumps && *after - end <= kRounding;
  return gap;
}

// Steps and splines may agree at all keys and differ between them: moments up to the next key.
void add_between(SceneComparison& comparison, const CommonTime& next) {
  const Moment last = comparison.moments.back();
  // Within the tolerance of times, a steep way is as good as a step.
  const double length = next.first - last.first_time;
  if (length <= std::max(4 * kRounding, 2 * comparison.options.tolerance.time)) return;
  const auto animation = [](const Scene& scene, int index) -> const Scene::Animation& {
    return scene.animations[static_cast<std::size_t>(index)];
  };
  const KeyGap a =
      gap_between(animation(comparison.first, last.first_animation), last.first_time, next.first);
  const KeyGap b = gap_between(animation(comparison.second, last.second_animation),
                               last.second_time, next.second);
  const auto add = [&](double share) {
    Moment moment = last;
    moment.after_frame = true;
    moment.first_time += share * length;
    moment.second_time += share * (next.second - last.second_time);
    comparison.moments.push_back(moment);
  };
  int parts = std::max(a.parts, b.parts);
  // Of motions, which are interpolated in world space, it is unknown how another file had them.
  const std::string& first = animation(comparison.first, last.first_animation).interpolation;
  const std::string& second = animation(comparison.second, last.second_animation).interpolation;
  const bool splines = (first + second).find("spline") != std::string::npos;
  if (first.empty() != second.empty() && parts > 1 && !splines) {
    ++comparison.turning_gaps;
    parts = 1;
  }
  for (int part = 1; part < parts; ++part) add(static_cast<double>(part) / parts);
  if (a.jumps || b.jumps) add(1 - kBeforeStep);
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
  const Error too_long("compare-too-long",
                       fmt::format("{} has more than a million times to compare", name));
  if (a.key_times.size() + b.key_times.size() + comparison.moments.size() > kMaxMoments) {
    return too_long;
  }
  if (std::abs(a.key_times.back() - b.key_times.back()) > same) {
    comparison.say(
        fmt::format("{}: {} s to {} s in the first, {} s to {} s in the second; only the common "
                    "range is compared",
                    name, readable(a.key_times.front()), readable(a.key_times.back()),
                    readable(b.key_times.front()), readable(b.key_times.back())));
  }

  if (a.interpolation != b.interpolation && !a.interpolation.empty() && !b.interpolation.empty()) {
    comparison.note(fmt::format("{}: {} interpolation in the first, {} in the second", name,
                                a.interpolation, b.interpolation));
  }
  int times = 0, frame = 0;
  for (const CommonTime& time : common_times(a.key_times, b.key_times, same)) {
    if (times++ > 0) add_between(comparison, time);
    if (comparison.moments.size() >= kMaxMoments) return too_long;
    if (time.key >= 0) frame = time.key;
    comparison.moments.push_back(
        {first_animation, second_animation, frame, time.key < 0, time.first, time.second});
    const ValueLocation place{
        .animation = comparison.first.animations.size() > 1 ? first_animation : -1,
        .frame = frame,
        .after_frame = time.key < 0,
        .time = time.first};
    comparison.result.times.add(std::abs(time.first - time.second), place);
  }
  const auto frames = static_cast<std::size_t>(times);
  if (frames > a.key_times.size() || frames > b.key_times.size()) {
    comparison.note(
        fmt::format("{}: {} key times in the first, {} in the second; compared at {} common times",
                    name, a.key_times.size(), b.key_times.size(), frames));
  }
  return {};
}

bool all_named(const std::vector<std::string>& names) {
  return std::ranges::none_of(names, [](const std::string& name) { return name.empty(); });
}

// By name. Of as many in both those that lack a partner are renamed ones in their order, if they
// last as long and names alone are not asked for.
ListMatch by_name(const SceneComparison& comparison, const std::vector<std::string>& first,
                  const std::vector<std::string>& second) {
  constexpr double kSame = 1e-3;  // seconds
  ListMatch match = match_lists(first, second, Matching::name);
  const auto duration = [](const Scene& scene, int animation) {
    const auto& times = scene.animations[static_cast<std::size_t>(animation)].key_times;
    return times.empty() ? 0.0 : times.back() - times.front();
  };
  if (first.size() != second.size() || comparison.options.matching == Matching::name) return match;
  ListMatch left = std::exchange(match, {});
  match.pairs = left.pairs;
  for (std::size_t k = 0; k < left.only_first.size(); ++k) {
    const int i = left.only_first[k], j = left.only_second[k];
    if (std::abs(duration(comparison.first, i) - duration(comparison.second, j)) < kSame) {
      match.pairs.emplace_back(i, j);
    } else {
      match.only_first.push_back(i);
      match.only_second.push_back(j);
    }
  }
  std::ranges::sort(match.pairs);
  return match;
}

// "; only in the first: animation Walk, animation Run and 2 more"
std::string only_in(const char* which, const std::vector<int>& animations,
                    const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 3;
  if (animations.empty()) return {};
  std::string text = fmt::format("; only in the {}: ", which);
  for (std::size_t k = 0; k < std::min(kNamed, animations.size()); ++k) {
    const int animation = animations[k];
    text += (k > 0 ? ", " : "") +
            label("animation", names[static_cast<std::size_t>(animation)], animation);
  }
  if (animations.size() > kNamed) text += fmt::format(" and {} more", animations.size() - kNamed);
  return text;
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
  const auto first_names = names_of(first), second_names = names_of(second);
  ListMatch match = match_lists(first_names, second_names, Matching::automatic);
  if (comparison.options.matching == Matching::order) {
    match = match_lists(first_names, second_names, Matching::order);
  } else if (all_named(first_names) && all_named(second_names)) {
    ListMatch named = by_name(comparison, first_names, second_names);
    // Files whose names are of two programs are paired by their order.
    const std::size_t fewer = std::min(first.size(), second.size());
    if (comparison.options.matching == Matching::name || 2 * named.pairs.size() >= fewer) {
      match = std::move(named);
    }
  }
  if (first.size() != second.size() || !match.only_first.empty()) {
    comparison.say(fmt::format("{} in the first, {} in the second",
                               counted(static_cast<long long>(first.size()), "animation"),
                               second.size()) +
                   only_in("first", match.only_first, first_names) +
                   only_in("second", match.only_second, second_names));
  }
  if (first.size() == second.size()) {
    // A bake is another file of the same motion.
    const bool baked =
        comparison.first.joint_names.empty() != comparison.second.joint_names.empty();
    const Matching matching = comparison.options.matching;
    const bool counts = !baked && matching != Matching::order && matching != Matching::nearest;
    for (const auto& [i, j] : match.pairs) {
      report_name(comparison, "animation", first_names[static_cast<std::size_t>(i)],
                  second_names[static_cast<std::size_t>(j)], counts);
    }
  }
  for (const auto& [i, j] : match.pairs) {
    if (auto added = add_moments(comparison, i, j); !added) return added;
  }
  if (comparison.turning_gaps > 0) {
    comparison.note(fmt::format(
        "a joint turns by more than 90 degrees from key to key {}, where motions, in world space, "
        "and glTF, relative to the parent, go different ways: compared at the keys alone",
        counted(comparison.turning_gaps, "time")));
  }
  if (comparison.moments.empty()) comparison.moments.push_back({});
  return {};
}

void compare_rest_pose(SceneComparison& comparison) {
  const Scene &first = comparison.first, &second = comparison.second;
  if (first.animations.empty() || second.animations.empty()) return;
  // A bake rests where its motion begins.
  if (first.joint_names.empty() != second.joint_names.empty()) return;
  SceneState a, b;
  first.evaluate(-1, 0, a);
  second.evaluate(-1, 0, b);
  // The largest of what is over its tolerance, in tolerances.
  double worst = 1;
  std::string where;
  const auto consider = [&](double size, double tolerance, const auto& text) {
    if (!(size > worst * tolerance)) return;
    worst = size / tolerance;
    where = text();
  };
  const Tolerance& tolerance = comparison.options.tolerance;
  for (const auto& [i, j] : comparison.joints) {
    const Transform &one = a.joints[at(i)], &other = b.joints[at(j)];
    const auto joint = [&, k = i] { return label("joint", first.joint_names[at(k)], k); };
    const double angle = angle_between(one.orientation, other.orientation);
    consider(angle, tolerance.of_joint_orientations(), [&] {
      return fmt::format("{} is turned by {} deg", joint(), readable(angle / kRadiansPerDegree, 3));
    });
    const double way = (one.position - other.position).norm();
    consider(way, tolerance.of_joint_positions(),
             [&] { return fmt::format("{} is {} mm off", joint(), readable(1000 * way, 3)); });
  }
  for (const auto& [i, j] : comparison.meshes) {
    const auto &one = a.positions[at(i)], &other = b.positions[at(j)];
    double most = 0;
    for (std::size_t v = 0; v < std::min(one.size(), other.size()); ++v) {
      most = std::max(most, (one[v] - other[v]).norm());
    }
    consider(most, tolerance.length, [&, k = i] {
      return fmt::format("{} is up to {} mm off", label("mesh", first.meshes[at(k)].name, k),
                         readable(1000 * most, 3));
    });
  }
  if (where.empty()) return;
  // A mesh may be bound in another pose than the reference pose of the motion that moves it.
  if (first.only_joints != second.only_joints) {
    comparison.note("without an animation, at rest: " + where + ", which no animation shows");
  } else {
    comparison.say("without an animation, at rest: " + where);
  }
}

}  // namespace krok::compare
