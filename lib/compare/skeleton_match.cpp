#include "compare/skeleton_match.h"

#include <fmt/format.h>

#include <unordered_map>

namespace krok::compare {

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
  constexpr std::size_t kShown = 3;
  std::string list;
  std::size_t missing = 0;
  for (const std::string& name : names) {
    if (other.contains(name)) continue;
    if (++missing <= kShown) list += (missing > 1 ? ", " : "") + name;
  }
  if (missing > kShown) list += fmt::format(" and {} more", missing - kShown);
  return list;
}

std::string name_of_parent(Names names, int parent) {
  if (parent < 0) return "none";
  const std::string& name = names[static_cast<std::size_t>(parent)];
  return name.empty() ? fmt::format("joint {}", parent) : name;
}

std::string difference_in_names(Names first, const NameIndex& first_index, Names second,
                                const NameIndex& second_index) {
  const std::string first_only = only_in(first, second_index);
  const std::string second_only = only_in(second, first_index);
  if (first_only.empty() && second_only.empty()) return {};
  std::string text =
      first.size() == second.size()
          ? fmt::format("both have {} joints", first.size())
          : fmt::format("{} joints in the first, {} in the second", first.size(), second.size());
  if (!first_only.empty()) text += fmt::format("; only in the first: {}", first_only);
  if (!second_only.empty()) text += fmt::format("; only in the second: {}", second_only);
  return text;
}

}  // namespace

SkeletonMatch match_joints(Names first_names, std::span<const int> first_parents,
                           Names second_names, std::span<const int> second_parents) {
  SkeletonMatch match;
  const NameIndex first_index = index_of_names(first_names);
  const NameIndex second_index = index_of_names(second_names);
  const bool by_name = !first_index.empty() && !second_index.empty();
  if (by_name) {
    match.difference = difference_in_names(first_names, first_index, second_names, second_index);
  } else if (first_names.size() != second_names.size()) {
    match.difference = fmt::format("{} joints in the first, {} in the second", first_names.size(),
                                   second_names.size());
  }
  if (!match.difference.empty()) return match;

  std::vector<int> second_of_first(first_names.size());
  for (std::size_t i = 0; i < first_names.size(); ++i) {
    second_of_first[i] = by_name ? second_index.at(first_names[i]) : static_cast<int>(i);
  }
  for (std::size_t i = 0; i < first_names.size(); ++i) {
    const int first_parent = first_parents[i];
    const int second_parent = second_parents[static_cast<std::size_t>(second_of_first[i])];
    const int expected =
        first_parent < 0 ? -1 : second_of_first[static_cast<std::size_t>(first_parent)];
    if (second_parent == expected) continue;
    match.difference = fmt::format("the parent of {} is {} in the first and {} in the second",
                                   name_of_parent(first_names, static_cast<int>(i)),
                                   name_of_parent(first_names, first_parent),
                                   name_of_parent(second_names, second_parent));
    return match;
  }
  match.second_of_first = std::move(second_of_first);
  return match;
}

SkeletonMatch match_skeletons(const Skeleton& first, const Skeleton& second) {
  SkeletonMatch match = match_joints(first.names, first.parents, second.names, second.parents);
  for (std::size_t i = 0; i < match.second_of_first.size(); ++i) {
    const auto j = static_cast<std::size_t>(match.second_of_first[i]);
    if ((first.end_sites[i] != 0) == (second.end_sites[j] != 0)) continue;
    match.difference = fmt::format("{} is {} in the first and {} in the second", first.names[i],
                                   first.end_sites[i] != 0 ? "an end site" : "a joint",
                                   second.end_sites[j] != 0 ? "an end site" : "a joint");
    match.second_of_first.clear();
    break;
  }
  return match;
}

}  // namespace krok::compare
