#include "compare/matching.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "core/numbers.h"

namespace krok::compare {

namespace {

using Names = std::span<const std::string>;

// Matches the k-th item of a name with the k-th item of that name.
ListMatch match_by_name(Names first, Names second) {
  ListMatch match;
  match.by_name = true;
  std::map<std::string_view, std::vector<int>> places;  // in reverse
  for (std::size_t i = second.size(); i-- > 0;) places[second[i]].push_back(static_cast<int>(i));
  std::vector<char> taken(second.size(), 0);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto found = places.find(first[i]);
    if (found == places.end() || found->second.empty()) {
      match.only_first.push_back(static_cast<int>(i));
      continue;
    }
    match.pairs.emplace_back(static_cast<int>(i), found->second.back());
    taken[static_cast<std::size_t>(found->second.back())] = 1;
    found->second.pop_back();
  }
  for (std::size_t i = 0; i < second.size(); ++i) {
    if (!taken[i]) match.only_second.push_back(static_cast<int>(i));
  }
  return match;
}

ListMatch match_by_place(std::size_t first, std::size_t second) {
  ListMatch match;
  const auto both = static_cast<int>(std::min(first, second));
  for (int i = 0; i < both; ++i) match.pairs.emplace_back(i, i);
  for (int i = both; i < static_cast<int>(first); ++i) match.only_first.push_back(i);
  for (int i = both; i < static_cast<int>(second); ++i) match.only_second.push_back(i);
  return match;
}

bool unique(Names names) {
  std::vector<std::string_view> sorted(names.begin(), names.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

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

ListMatch match_lists(Names first, Names second, Matching matching) {
  if (matching == Matching::order) return match_by_place(first.size(), second.size());
  if (matching == Matching::name) return match_by_name(first, second);
  if (first.size() == second.size() && unique(first)) {
    ListMatch match = match_by_name(first, second);
    if (match.only_first.empty()) return match;
  }
  return match_by_place(first.size(), second.size());
}

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
