#pragma once

#include <memory>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// A plane that is level at height 0 up to z = `begin` metres, then rises along +Z at `angle`
// radians without end; below 0 it falls. On the crease itself the level side's normal counts.
// Code: ground-value for an angle of 60 degrees and more, and values that are not finite.
Result<std::unique_ptr<Terrain>> slope(double angle, double begin = 1);

}  // namespace krok::terrain
