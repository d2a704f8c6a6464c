#pragma once

#include <string>

#include "math/types.h"
#include "parametric/parameter.h"

// Parameters in readable units: lengths in millimetres or metres, angles in degrees, times in
// milliseconds or seconds.

namespace krok::cli::fit {

// A unit for values or errors, and the factor from the parameter's own unit.
struct ShownUnit {
  std::string name;
  double factor = 1;
};
ShownUnit unit_for_values(const parametric::Parameter& parameter);
ShownUnit unit_for_errors(const parametric::Parameter& parameter);

}  // namespace krok::cli::fit
