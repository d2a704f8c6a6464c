#pragma once

#include <string>
#include <vector>

#include "formats/steps/steps.h"

namespace krok::steps {

// What the library's parameters are called, [parameters]: as its report says (the member
// "parameters", a list of objects with a "name"), otherwise what stands behind the last dot of what
// is measured: "length" for "step.length".
std::vector<std::string> parameter_names(const StepsFile& steps);

}  // namespace krok::steps
