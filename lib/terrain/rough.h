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

}  // namespace krok::terrain
