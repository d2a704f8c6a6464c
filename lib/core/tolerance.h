#pragma once

#include <string_view>

#include "core/result.h"

namespace krok {

// parse_length() for what needs a unit: "0.1mm", or 0. A bare number would be metres, and hardly
// anybody means those in a tolerance, or in a person's height. `usual` is for the message. Codes:
// those of parse_length(), quantity-no-unit.
Result<double> parse_length_with_unit(std::string_view text, std::string_view usual);
inline Result<double> parse_length_tolerance(std::string_view text) {
  return parse_length_with_unit(text, "mm");
}

}  // namespace krok
