#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/skeleton.h"

// Which joint of one skeleton is which of another.

namespace krok::compare {

struct SkeletonMatch {
  // What differs, in words for people: joints that only one has, a joint under another parent, an
  // end site that the other has as a joint. Empty if nothing does; the order of joints is nothing.
  std::string difference;
  // For each joint of the first the joint of the second with the same name. Filled if `difference`
  // is empty.
  std::vector<int> second_of_first;
};

SkeletonMatch match_skeletons(const Skeleton& first, const Skeleton& second);

// The same for joints given as names and parents (index or -1). Where names are missing or not
// unique, joints are matched by their place in the list.
SkeletonMatch match_joints(std::span<const std::string> first_names,
                           std::span<const int> first_parents,
                           std::span<const std::string> second_names,
                           std::span<const int> second_parents);

}  // namespace krok::compare
