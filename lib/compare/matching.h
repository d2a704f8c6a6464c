#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/skeleton.h"

// Matches the items of two lists.

namespace krok::compare {

// How items of the first list are matched to items of the second.
enum class Matching {
  // By name if all names of both are unique and the same set, otherwise by index. Vertices by
  // index.
  automatic,
  // By index, whatever the names. Vertices by index.
  order,
  // By name, whatever the index; repeated names in order of occurrence. Items that only one has are
  // reported, the rest is compared. Vertices by index.
  name,
  // As `automatic`, but each vertex is matched to the nearest point of the other's surface, in both
  // directions: for meshes with another number or order of vertices, other triangles or other
  // parts.
  nearest,
};

using Pairs = std::vector<std::pair<int, int>>;  // of the first, of the second

struct ListMatch {
  Pairs pairs;                               // in the order of the first
  std::vector<int> only_first, only_second;  // items without a partner
  bool by_name = false;
};

ListMatch match_lists(std::span<const std::string> first, std::span<const std::string> second,
                      Matching matching);

// Which evenly spaced frames of two recordings correspond; see ClipDifference.
struct FrameMatch {
  std::vector<std::pair<int, int>> frames;  // of the first, of the second
  std::vector<std::string> differences;     // readable sentences
};

// Rates are positive and finite. Rates are equal if they agree within 1e-6, or if no common frame
// differs in time by more than `same_time` (seconds).
FrameMatch match_frames(int first_frames, double first_rate, int second_frames, double second_rate,
                        double same_time = 0);

// Matches the joints of two skeletons.

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
