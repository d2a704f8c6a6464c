#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "tools/krok-fit/fit_library.h"

namespace krok::fit_tool {

// A chart's file name and its SVG.
using Chart = std::pair<std::string, std::string>;

// errors.svg: the largest error by inserted points, for each parameter. weights.svg: the weights of
// up to nine examples over the first two parameters, the others in the middle of their range.
// parameters.svg: examples and inserted points, for each two parameters. measured.svg: the error of
// what is measured by what is asked, before and after. Codes: those of draw::to_svg.
Result<std::vector<Chart>> make_charts(const LibraryInput& input, const FittedLibrary& fitted);

}  // namespace krok::fit_tool
