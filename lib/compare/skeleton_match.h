#pragma once

#include <span>
#include <string>
#include <vector>

#include "compare/matching.h"
#include "scene/skeleton.h"

// Matches the joints of two skeletons.

namespace krok::compare {

struct SkeletonMatch {
  // Readable difference: joints that only one has, a joint with another parent, an end site that is
  // a joint in the other. Empty if there is none; the order of joints is ignored.
  std::string difference;
  // The second's joint for each joint of the first, -1 for joints that only the first has. Empty if
  // they are matched by index and there is a difference.
  std::vector<int> second_of_first;
};

// Matching::automatic: by name, or by index if names are missing or not unique.
SkeletonMatch match_skeletons(const Skeleton& first, const Skeleton& second,
                              Matching matching = Matching::automatic);

// The same for joints given as names and parents (index or -1).
SkeletonMatch match_joints(std::span<const std::string> first_names,
                           std::span<const int> first_parents,
                           std::span<const std::string> second_names,
                           std::span<const int> second_parents,
                           Matching matching = Matching::automatic);

}  // namespace krok::compare
