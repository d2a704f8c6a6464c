#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "parametric/library.h"

namespace krok::parametric {

// Selects examples so that no two are closer than `spacing` in parameters scaled by their ranges;
// returns ascending indices. Weight functions interpolate every example, so two steps with similar
// parameters but slightly different motions cause large weights of opposite sign: on 42 captured
// steps a spacing of 0.15 kept 15, reduced the largest error of length from 308 mm to 6 mm before
// refinement, and raised the lowest weight from -8 to -0.3.
// Farthest-point sampling: the first is the example nearest to the mean of all, each further one
// the farthest from those kept, so that extremes are kept. A spacing of 0 or less keeps all.
// `most`: how many are kept at most, at any spacing greater than 0; at least 1.
std::vector<int> thin_out(const Library& library, double spacing,
                          std::size_t most = std::numeric_limits<std::size_t>::max());

// Max examples of smoothed weights: the time grows with their third power, and more make no
// difference that could be measured.
inline constexpr std::size_t kMaxSmoothed = 500;

// Selects examples whose weights are smoothed, ascending: all that are not the same, up to
// kMaxSmoothed, in which styles have equal shares. Half of a style's are the farthest apart, the
// others evenly taken from the rest, since usual steps are not at the ends.
std::vector<int> thin_out_smoothed(const Library& library);

}  // namespace krok::parametric
