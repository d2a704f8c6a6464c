#include "compare/matching.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <unordered_map>

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

namespace {

using Names = std::span<const std::string>;
using NameIndex = std::unordered_map<std::string_view, int>;

// Empty if a name is missing or not unique.
NameIndex index_of_names(Names names) {
  NameIndex index;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty() || !index.emplace(names[i], static_cast<int>(i)).second) return {};
  }
  return index;
}

std::string only_in(Names names, const NameIndex& other) {
  constexpr std::size_t kListed = 3;
  std::string list;
  std::size_t missing = 0;
  for (const std::string& name : names) {
    if (other.contains(name)) continue;
    if (++missing <= kListed) list += (missing > 1 ? ", " : "") + name;
  }
  if (missing > kListed) list += fmt::format(" and {} more", missing - kListed);
  return list;
}

std::string name_of_joint(Names names, int joint) {
  const std::string& name = names[static_cast<std::size_t>(joint)];
  return name.empty() ? fmt::format("joint {}", joint) : name;
}

std::string name_of_parent(Names names, int parent) {
  return parent < 0 ? "none" : name_of_joint(names, parent);
}

std::string joints(std::size_t count) {
  return counted(static_cast<long long>(count), "joint");
}

std::string difference_in_names(Names first, const NameIndex& first_index, Names second,
                                const NameIndex& second_index) {
  const std::string first_only = only_in(first, second_index);
  const std::string second_only = only_in(second, first_index);
  if (first_only.empty() && second_only.empty()) return {};
  std::string text =
      first.size() == second.size()
          ? fmt::format("both have {}", joints(first.size()))
          : fmt::format("{} in the first, {} in the second", joints(first.size()), second.size());
  if (!first_only.empty()) text += fmt::format("; only in the first: {}", first_only);
  if (!second_only.empty()) text += fmt::format("; only in the second: {}", second_only);
  return text;
}

}  // namespace

SkeletonMatch match_joints(Names first_names, std::span<const int> first_parents,
                           Names second_names, std::span<const int> second_parents,
                           Matching matching) {
  SkeletonMatch match;
  const NameIndex first_index = index_of_names(first_names);
  const NameIndex second_index = index_of_names(second_names);
  const bool unique = !first_index.empty() && !second_index.empty();
  const bool by_name = matching == Matching::name || (unique && matching != Matching::order);
  if (by_name && unique) {
    match.difference = difference_in_names(first_names, first_index, second_names, second_index);
  } else if (first_names.size() != second_names.size()) {
    match.difference = fmt::format("{} in the first, {} in the second", joints(first_names.size()),
                                   second_names.size());
  }
  if (!match.difference.empty() && !by_name) return match;

  std::vector<int> second_of_first(first_names.size(), -1);
  const ListMatch list =
      match_lists(first_names, second_names, by_name ? Matching::name : Matching::order);
  for (const auto& [i, j] : list.pairs) second_of_first[static_cast<std::size_t>(i)] = j;
  for (const auto& [i, j] : list.pairs) {
    if (!match.difference.empty()) break;
    const int first_parent = first_parents[static_cast<std::size_t>(i)];
    const int second_parent = second_parents[static_cast<std::size_t>(j)];
    const int expected =
        first_parent < 0 ? -1 : second_of_first[static_cast<std::size_t>(first_parent)];
    if (second_parent == expected) continue;
    match.difference = fmt::format(
        "the parent of {} is {} in the first and {} in the second", name_of_joint(first_names, i),
        name_of_parent(first_names, first_parent), name_of_parent(second_names, second_parent));
  }
  if (match.difference.empty() || by_name) {
    match.second_of_first = std::move(second_of_first);
  }
  return match;
}

SkeletonMatch match_skeletons(const Skeleton& first, const Skeleton& second, Matching matching) {
  SkeletonMatch match =
      match_joints(first.names, first.parents, second.names, second.parents, matching);
  for (std::size_t i = 0; i < match.second_of_first.size() && match.difference.empty(); ++i) {
    if (match.second_of_first[i] < 0) continue;
    const auto j = static_cast<std::size_t>(match.second_of_first[i]);
    if ((first.end_sites[i] != 0) == (second.end_sites[j] != 0)) continue;
    match.difference = fmt::format("{} is {} in the first and {} in the second", first.names[i],
                                   first.end_sites[i] != 0 ? "an end site" : "a joint",
                                   second.end_sites[j] != 0 ? "an end site" : "a joint");
  }
  return match;
}

}  // namespace krok::compare
