#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "parametric/parameter.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-fit/fit_library.h"

namespace krok::cli::fit {

// The report for --json.
Json report_json(const LibraryInput& input, const FittedLibrary& fitted);

// The same with the data needed to resume, see saved_fit.h; formats/steps stores it in the file.
Json saved_json(const LibraryInput& input, const FittedLibrary& fitted);

// Logs a short summary: the examples, errors before and after, why refinement stopped.
void say_report(const LibraryInput& input, const FittedLibrary& fitted, ToolContext& context);

// A chart's file name and its SVG.
using ChartFile = std::pair<std::string, std::string>;

// errors.svg: largest error by inserted points, per parameter. weights.svg: weights of up to nine
// examples over the first two parameters, the others at the middle of their range. parameters.svg:
// examples and inserted points, for each pair of parameters. measured.svg: error of the measured
// parameters by the requested ones, before and after refinement. Codes: those of draw::to_svg.
Result<std::vector<ChartFile>> make_charts(const LibraryInput& input, const FittedLibrary& fitted);

// Parameters in readable units: lengths in millimetres or metres, angles in degrees, times in
// milliseconds or seconds.

// A unit for values or errors, and the factor from the parameter's own unit.
struct ShownUnit {
  std::string name;
  double factor = 1;
};
ShownUnit unit_for_values(const parametric::Parameter& parameter);
ShownUnit unit_for_errors(const parametric::Parameter& parameter);

}  // namespace krok::cli::fit
