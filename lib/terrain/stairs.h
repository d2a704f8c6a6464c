#pragma once

#include <memory>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

struct StairsOptions {
  double rise = 0.17;  // metres from tread to tread, -1 to 1 but not 0; below 0 they go down
  double run = 0.29;   // metres from edge to edge, 0.05 to 100
  int count = 20;      // risers, 1 to 100,000
  double begin = 1;    // metres, z of the first riser
};

// Stairs along +Z, without end to both sides: level at height 0 before `begin`, then treads `run`
// long, each `rise` above the one before, then a level landing at count * rise. At an edge the
// upper tread counts. Code: ground-value for values outside the ranges above.
Result<std::unique_ptr<Terrain>> stairs(const StairsOptions& options);

}  // namespace krok::terrain
