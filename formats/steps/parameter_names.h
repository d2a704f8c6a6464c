#pragma once

#include <string>
#include <vector>

#include "formats/steps/steps.h"

namespace krok::steps {

// Names of the library's parameters, [parameters]: from its report (the member "parameters", an
// array of objects with a "name"), or else the part after the last dot of the measure: "length" for
// "step.length".
std::vector<std::string> parameter_names(const StepsFile& steps);

}  // namespace krok::steps
