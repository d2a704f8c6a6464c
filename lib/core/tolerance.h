#pragma once

#include <string_view>

#include "core/result.h"

namespace krok {

// parse_length() for tolerances, which need a unit: "0.1mm", or 0. A bare number would be metres,
// and hardly anybody means those. Codes: those of parse_length(), quantity-no-unit.
Result<double> parse_length_tolerance(std::string_view text);

}  // namespace krok
