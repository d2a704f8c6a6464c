#pragma once

#include "fit/refine.h"

namespace krok::fit::detail {

// Restores the rows as they were found. Affine part and coefficients are still those of the
// polished rows; a solver recomputes them.
Refined without_polish(Refined refined);

}  // namespace krok::fit::detail
