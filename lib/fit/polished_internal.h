#pragma once

#include "fit/refine.h"

namespace krok::fit::detail {

// With the rows as they were found. Its planes and coefficients are still those of the polished
// rows; a solver makes them anew.
Refined without_polish(Refined refined);

}  // namespace krok::fit::detail
