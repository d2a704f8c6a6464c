#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/morph_set.h"

namespace krok::compare {

// How far two sets of morph targets are apart. Vertices are matched by number; provenance does not
// matter.
struct MorphDifference {
  // What keeps the two from being the same whatever the tolerance: other numbers of vertices (then
  // nothing was measured), targets or normals that only one has. Sentences for people.
  std::vector<std::string> structure;

  int compared_targets = 0;
  Measure positions;  // metres
  Measure normals;    // radians

  bool same() const { return structure.empty() && positions.within() && normals.within(); }
};

// Targets are matched by place for Matching::order, else by name. An Error if one of the sets
// fails its check(). Places carry targets and vertices of `first`.
Result<MorphDifference> difference(const MorphSet& first, const MorphSet& second,
                                   const Tolerance& tolerance,
                                   Matching matching = Matching::automatic);

}  // namespace krok::compare
