#include "core/tolerance.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "core/quantity.h"

namespace krok {

Result<double> parse_length_tolerance(std::string_view text) {
  const auto bare = parse_finite(text);
  if (bare && *bare != 0) {
    return Error("quantity-no-unit", fmt::format("'{}' has no unit", text),
                 fmt::format("write {}mm, or {}m if metres are meant", text, text));
  }
  return parse_length(text);
}

}  // namespace krok
