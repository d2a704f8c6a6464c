#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

// Which item of one list is which of another.

namespace krok::compare {

// What of the first belongs to what of the second.
enum class Matching {
  // By name where all names of both are unique and the same, otherwise by place. Vertices by
  // number.
  automatic,
  // By place in the list, whatever the names. Vertices by number.
  order,
  // By name, whatever the place; of a name that repeats the first with the first. What only one has
  // is said, the rest compared. Vertices by number.
  name,
  // As in `automatic`, but each vertex with the nearest point of the other's surface, both ways:
  // for meshes with other numbers or another order of vertices, other triangles or other parts.
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

}  // namespace krok::compare
