#include "timeline/in_step.h"

#include <algorithm>
#include <cmath>

#include "blend/time_map.h"

namespace krok::timeline {

namespace {

constexpr double kLongestStep = 10;  // max seconds between matched keytimes
constexpr int kParts = 256;          // per crossfade
constexpr std::size_t kMaxKeys = 4000;

struct Pairs {
  std::vector<double> previous, next;  // play times of the shared keytimes
  std::size_t begin = 0;               // the crossfade begins after this one
};

// The shared keytimes around keytime `p` of the previous motion and `n` of the next.
Pairs pairs_around(const std::vector<PlayedKey>& previous, std::size_t p,
                   const std::vector<PlayedKey>& next, std::size_t n) {
  Pairs pairs;
  const auto same = [&](std::size_t a, std::size_t b) {
    return previous[a].key->name == next[b].key->name;
  };
  std::size_t back = 0;
  while (back < 2 && back < p && back < n && same(p - back - 1, n - back - 1)) ++back;
  pairs.begin = back;
  for (std::size_t k = 0; p - back + k < previous.size() && n - back + k < next.size() &&
                          same(p - back + k, n - back + k);
       ++k) {
    pairs.previous.push_back(previous[p - back + k].play_time);
    pairs.next.push_back(next[n - back + k].play_time);
  }
  return pairs;
}

double generic_at(const blend::TimeMap& map, double low, double time) {
  double high = low + 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (map.at(middle) < time ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

InStep integrate(const Pairs& pairs, double previous_play, double duration, const Easing& easing) {
  const blend::TimeMap a(pairs.previous, blend::Warp::pchip), b(pairs.next, blend::Warp::pchip);
  double generic = generic_at(a, static_cast<double>(pairs.begin), previous_play);
  InStep result;
  result.skipped = b.at(generic);
  result.previous.push_back(previous_play);
  result.next.push_back(result.skipped);
  const double step = duration / kParts;
  // Generic time per second; the slope of a monotone cubic may be 0 at a keytime.
  const auto speed = [&](double at, double part) {
    const double weight = std::clamp(easing.at(part / kParts), 0.0, 1.0);
    return 1 / std::max((1 - weight) * a.slope(at) + weight * b.slope(at), 1e-3);
  };
  for (int i = 0; i < kParts; ++i) {
    if (generic < a.last()) {
      const double half = generic + 0.5 * step * speed(generic, i);
      const double moved = std::min(generic + step * speed(half, i + 0.5), a.last());
      const double went = moved - generic;
      generic = moved;
      if (went > 0 && generic < a.last()) {
        result.previous.push_back(a.at(generic));
        result.next.push_back(b.at(generic));
        continue;
      }
    }
    result.previous.push_back(result.previous.back() + step);
    result.next.push_back(result.next.back() + step);
  }
  return result;
}

std::optional<InStep> align(const std::vector<PlayedKey>& before,
                            const std::vector<PlayedKey>& after, double previous_play,
                            double duration, const Easing& easing) {
  if (before.size() < 2 || after.size() < 2) return std::nullopt;
  // The last keytime with another after it: a motion that ends with a step is still within it.
  std::size_t p = 0;
  while (p + 2 < before.size() && before[p + 1].play_time <= previous_play) ++p;
  if (before[p].play_time > previous_play || before[p + 1].play_time < previous_play) {
    return std::nullopt;
  }
  for (std::size_t n = 0; n + 1 < after.size(); ++n) {
    if (before[p].key->name != after[n].key->name ||
        before[p + 1].key->name != after[n + 1].key->name) {
      continue;
    }
    const InStep found =
        integrate(pairs_around(before, p, after, n), previous_play, duration, easing);
    if (found.skipped >= -1e-9) return found;
  }
  return std::nullopt;
}

std::vector<PlayedKey> strikes_of(std::vector<PlayedKey> keys) {
  std::erase_if(keys, [](const PlayedKey& key) { return !key.key->name.ends_with("_strike"); });
  return keys;
}

}  // namespace

std::optional<InStep> play_in_step(const StepSide& previous, const StepSide& next,
                                   double previous_play, double duration, const Easing& easing) {
  if (previous.keys == nullptr || next.keys == nullptr) return std::nullopt;
  const auto before = played_keys(previous.range, *previous.keys, previous_play - kLongestStep,
                                  previous_play + 4 * duration + kLongestStep, kMaxKeys);
  const double most = std::min(next.range.duration(), 60.0);
  const auto after =
      played_keys(next.range, *next.keys, -kLongestStep, most + 4 * duration, kMaxKeys);
  if (before.size() > kMaxKeys || after.size() > kMaxKeys) return std::nullopt;
  auto found = align(before, after, previous_play, duration, easing);
  // In a run the foot leaves before the other one strikes, in a walk after it: only the strikes
  // come in the same order.
  if (!found) {
    found = align(strikes_of(before), strikes_of(after), previous_play, duration, easing);
  }
  return found;
}

}  // namespace krok::timeline
