#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/morph_set.h"

namespace krok::compare {

// Difference of two sets of morph targets. Vertices are matched by index; provenance is ignored.
struct MorphDifference {
  // Differences that no tolerance covers: other vertex counts (then nothing is measured), targets
  // or normals that only one has. Readable sentences.
  std::vector<std::string> structure;

  int compared_targets = 0;
  Measure positions;  // metres
  Measure normals;    // radians

  bool same() const { return structure.empty() && positions.within() && normals.within(); }
};

// Targets are matched by index for Matching::order, else by name. An Error if a set fails its
// check(). Locations have targets and vertices of `first`.
Result<MorphDifference> difference(const MorphSet& first, const MorphSet& second,
                                   const Tolerance& tolerance,
                                   Matching matching = Matching::automatic);

}  // namespace krok::compare
