#pragma once

#include <cstdint>
#include <memory>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

struct RoughOptions {
  std::uint64_t seed = 1;
  double height = 0.08;  // metres from the lowest place possible to the highest, 0 to 10
};

// Rough ground without end, the same for the same options on every machine: the sum of two value
// noises (random heights on a square lattice, joined by the quintic 6 t^5 - 15 t^4 + 10 t^3, so
// that height, slope and curvature are continuous), of wavelengths 1.2 m and 0.4 m, that is
// lattices of 0.6 m and 0.2 m, which have 3/4 and 1/4 of the height. It is 0 within 0.3 m of the
// origin, where the walker starts, and grows to its full height over the next 0.7 m. Beyond 1e9 m
// there is none. Code: ground-value for a height outside the range.
Result<std::unique_ptr<Terrain>> rough(const RoughOptions& options);

// A level plane without end, `height` metres above the origin.
// Code: ground-value for a height that is not finite.
Result<std::unique_ptr<Terrain>> level(double height = 0);

// A plane that is level at height 0 up to z = `begin` metres, then rises along +Z at `angle`
// radians without end; below 0 it falls. On the crease itself the level side's normal counts.
// Code: ground-value for an angle of 60 degrees and more, and values that are not finite.
Result<std::unique_ptr<Terrain>> slope(double angle, double begin = 1);

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
