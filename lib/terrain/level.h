#pragma once

#include <memory>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// A level plane without end, `height` metres above the origin.
// Code: ground-value for a height that is not finite.
Result<std::unique_ptr<Terrain>> level(double height = 0);

}  // namespace krok::terrain
