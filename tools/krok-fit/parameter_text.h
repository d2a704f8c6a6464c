#pragma once

#include <string>

#include "math/types.h"
#include "parametric/parameter.h"

// Parameters as people read them: lengths in millimetres or metres, angles in degrees, times in
// milliseconds or seconds.

namespace krok::fit_tool {

// A unit for values or for their errors, and what a value in the parameter's own unit is times.
struct ShownUnit {
  std::string name;
  double factor = 1;
};
ShownUnit unit_for_values(const parametric::Parameter& parameter);
ShownUnit unit_for_errors(const parametric::Parameter& parameter);

}  // namespace krok::fit_tool
