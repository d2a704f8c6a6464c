#pragma once

#include <vector>

#include "math/types.h"

namespace krok::draw {

// The outline of a left sole, seen from above, in parts of its length: x to the left, y ahead, from
// the heel at (0, 0) to the tip at 1; closed. A right one is its mirror image.
std::vector<Vec2> sole_outline();

}  // namespace krok::draw
