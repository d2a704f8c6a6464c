#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "tools/krok-fit/fit_library.h"

namespace krok::cli::fit {

// A chart's file name and its SVG.
using ChartFile = std::pair<std::string, std::string>;

// errors.svg: largest error by inserted points, per parameter. weights.svg: weights of up to nine
// examples over the first two parameters, the others at the middle of their range. parameters.svg:
// examples and inserted points, for each pair of parameters. measured.svg: error of the measured
// parameters by the requested ones, before and after refinement. Codes: those of draw::to_svg.
Result<std::vector<ChartFile>> make_charts(const LibraryInput& input, const FittedLibrary& fitted);

}  // namespace krok::cli::fit
