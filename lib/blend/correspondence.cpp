#include "blend/correspondence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/numbers.h"

namespace krok::blend {

namespace {

constexpr double kApart = 1e-6;  // seconds

bool same_names(const KeyedMotion& a, const KeyedMotion& b) {
  return std::ranges::equal(a.keys->keytimes, b.keys->keytimes, {}, &Keytime::name, &Keytime::name);
}

Correspondence take_all(std::span<const KeyedMotion> motions) {
  const bool begins = std::ranges::all_of(motions, [](const KeyedMotion& motion) {
    return motion.keys->keytimes.front().time > motion.shortest;
  });
  const bool ends = std::ranges::all_of(motions, [](const KeyedMotion& motion) {
    return motion.keys->keytimes.back().time < motion.duration - motion.shortest;
  });
  Correspondence result;
  if (begins) result.names.emplace_back("begin");
  for (const Keytime& key : motions.front().keys->keytimes) result.names.push_back(key.name);
  if (ends) result.names.emplace_back("end");
  for (const KeyedMotion& motion : motions) {
    auto& times = result.times.emplace_back();
    if (begins) times.push_back(0);
    for (const Keytime& key : motion.keys->keytimes) {
      times.push_back(std::clamp(key.time, 0.0, motion.duration));
    }
    if (!begins && times.front() <= motion.shortest) times.front() = 0;
    if (!ends && times.back() >= motion.duration - motion.shortest) times.back() = motion.duration;
    if (ends) times.push_back(motion.duration);
  }
  return result;
}

// Removes moments that are too close to the previous one in any motion, but not the first and last.
void thin_out(std::span<const KeyedMotion> motions, Correspondence& moments) {
  const auto too_soon = [&](std::size_t moment) {
    for (std::size_t m = 0; m < motions.size(); ++m) {
      const auto& times = moments.times[m];
      if (times[moment] - times[moment - 1] < motions[m].shortest) return true;
    }
    return false;
  };
  for (std::size_t k = 1; k < moments.names.size();) {
    if (!too_soon(k) || moments.names.size() == 2) {
      ++k;
      continue;
    }
    const std::size_t left_out = k + 1 == moments.names.size() && k > 1 ? k - 1 : k;
    moments.notes.push_back(
        make_diagnostic(Severity::note, "blend-keys",
                        fmt::format("{} is left out: it is within two frames of another keytime",
                                    moments.names[left_out])));
    const auto place = static_cast<std::ptrdiff_t>(left_out);
    moments.names.erase(moments.names.begin() + place);
    for (auto& times : moments.times) times.erase(times.begin() + place);
    k = std::max<std::size_t>(1, std::min(k, left_out));
  }
}

// For each keytime of `first` the matching one of `other`, or -1: the range with the most matching
// names, skipping at most one keytime in a row on either side, as when two nearly simultaneous
// events are in a different order. Local alignment after Smith and Waterman (Identification of
// common molecular subsequences, J. Mol. Biol. 147, 1981).
std::vector<int> align(const std::vector<Keytime>& first, const std::vector<Keytime>& other) {
  constexpr int kSame = 4, kPassedOver = 1;
  const std::size_t n = first.size(), m = other.size();
  std::vector<int> score(n * m, 0);
  std::vector<std::int8_t> from(n * m, -1);  // 2 * skipped in first + skipped in other
  std::size_t best_i = 0, best_j = 0;
  int best = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      if (first[i].name != other[j].name) continue;
      int& here = score[i * m + j];
      here = kSame;
      for (std::size_t a = 0; a < 2 && a < i; ++a) {
        for (std::size_t b = 0; b < 2 && b < j; ++b) {
          const int before = score[(i - 1 - a) * m + (j - 1 - b)];
          const int sum = before + kSame - kPassedOver * static_cast<int>(a + b);
          if (before == 0 || sum <= here) continue;
          here = sum;
          from[i * m + j] = static_cast<std::int8_t>(2 * a + b);
        }
      }
      if (here <= best) continue;
      best = here;
      best_i = i;
      best_j = j;
    }
  }
  std::vector<int> same(n, -1);
  while (best > 0) {
    same[best_i] = static_cast<int>(best_j);
    const std::int8_t step = from[best_i * m + best_j];
    if (step < 0) break;
    best_i -= 1 + static_cast<std::size_t>(step / 2);
    best_j -= 1 + static_cast<std::size_t>(step % 2);
  }
  return same;
}

// For each motion the indices of the common keytimes: [motions][moments].
std::vector<std::vector<int>> common_keytimes(std::span<const KeyedMotion> motions) {
  const auto& first = motions.front().keys->keytimes;
  std::vector<std::vector<int>> same;
  for (const KeyedMotion& motion : motions) same.push_back(align(first, motion.keys->keytimes));
  std::vector<std::vector<int>> common(motions.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (!std::ranges::all_of(same, [&](const auto& found) { return found[k] >= 0; })) continue;
    for (std::size_t m = 0; m < motions.size(); ++m) common[m].push_back(same[m][k]);
  }
  return common;
}

}  // namespace

Status check(const Correspondence& correspondence) {
  if (correspondence.moments() < 2 || correspondence.times.empty()) {
    return Error("blend-keys", "the motions need at least two common keytimes");
  }
  for (const auto& times : correspondence.times) {
    bool sound = times.size() == correspondence.names.size() && std::isfinite(times.front()) &&
                 std::isfinite(times.back());
    for (std::size_t i = 1; sound && i < times.size(); ++i) {
      sound = times[i] >= times[i - 1] + kApart;
    }
    if (!sound) {
      return Error("blend-keys", "the keytimes of a motion are not increasing");
    }
  }
  return {};
}

Result<Correspondence> ends_alone(std::span<const double> durations) {
  Correspondence result;
  result.names = {"begin", "end"};
  for (const double duration : durations) {
    if (!(duration > 0) || !std::isfinite(duration)) {
      return Error("blend-duration", "a motion with one frame cannot be time-warped",
                   "use motions with at least two frames");
    }
    result.times.push_back({0, duration});
  }
  return result;
}

Result<Correspondence> match_keytimes(std::span<const KeyedMotion> motions) {
  constexpr std::size_t kMax = 5000;
  for (const KeyedMotion& motion : motions) {
    if (motion.keys != nullptr && motion.keys->keytimes.size() > kMax) {
      return Error("blend-keys",
                   fmt::format("{} has {} keytimes; at most {} can be matched", motion.name,
                               motion.keys->keytimes.size(), kMax),
                   "cut the motion with krok-edit --from --to");
    }
    if (motion.keys == nullptr || motion.keys->keytimes.empty()) {
      return Error("blend-keys", fmt::format("{} has no keytimes", motion.name),
                   "detect or set them with krok-keys, or use --warp dtw or --contacts none");
    }
  }
  const bool all_alike = std::ranges::all_of(
      motions, [&](const KeyedMotion& motion) { return same_names(motion, motions.front()); });
  if (all_alike) {
    Correspondence result = take_all(motions);
    if (result.moments() >= 2) {
      thin_out(motions, result);
      return result;
    }
  }
  const auto common = common_keytimes(motions);
  if (common.front().size() < 2) {
    std::string sequences;
    for (const KeyedMotion& motion : motions) {
      sequences += fmt::format("; {}:", motion.name);
      for (std::size_t i = 0; i < std::min<std::size_t>(motion.keys->keytimes.size(), 6); ++i) {
        sequences += " " + motion.keys->keytimes[i].name;
      }
      if (motion.keys->keytimes.size() > 6) sequences += " ...";
    }
    return Error("blend-keys", "fewer than two keytimes are common to all motions" + sequences,
                 "give them the same names with krok-keys --keytime, or use --warp dtw");
  }
  Correspondence result;
  for (const int k : common.front()) {
    result.names.push_back(motions.front().keys->keytimes[static_cast<std::size_t>(k)].name);
  }
  for (std::size_t m = 0; m < motions.size(); ++m) {
    auto& times = result.times.emplace_back();
    for (const int k : common[m]) {
      times.push_back(motions[m].keys->keytimes[static_cast<std::size_t>(k)].time);
    }
    result.notes.push_back(make_diagnostic(
        Severity::note, "blend-keys",
        fmt::format("{}: uses {} s to {} s of {} s, from {} to {}, the range common to all motions",
                    motions[m].name, readable(times.front()), readable(times.back()),
                    readable(motions[m].duration), result.names.front(), result.names.back())));
  }
  thin_out(motions, result);
  return result;
}

}  // namespace krok::blend
