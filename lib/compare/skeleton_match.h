#pragma once

#include <span>
#include <string>
#include <vector>

#include "compare/matching.h"
#include "scene/skeleton.h"

// Which joint of one skeleton is which of another.

namespace krok::compare {

struct SkeletonMatch {
  // What differs, in words for people: joints that only one has, a joint under another parent, an
  // end site that the other has as a joint. Empty if nothing does; the order of joints is nothing.
  std::string difference;
  // For each joint of the first the joint of the second that it is. Filled if `difference` is
  // empty; for Matching::name in any case, with -1 for joints that only the first has.
  std::vector<int> second_of_first;
};

// Matching::automatic: by name, or by place in the list where names are missing or not unique.
SkeletonMatch match_skeletons(const Skeleton& first, const Skeleton& second,
                              Matching matching = Matching::automatic);

// The same for joints given as names and parents (index or -1).
SkeletonMatch match_joints(std::span<const std::string> first_names,
                           std::span<const int> first_parents,
                           std::span<const std::string> second_names,
                           std::span<const int> second_parents,
                           Matching matching = Matching::automatic);

}  // namespace krok::compare
