#include "core/tolerance.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "core/quantity.h"

namespace krok {

Result<double> parse_length_with_unit(std::string_view text, std::string_view usual) {
  const auto bare = parse_finite(text);
  if (bare && *bare != 0) {
    return Error("quantity-no-unit", fmt::format("'{}' has no unit", text),
                 fmt::format("write {}{}, or {}m if metres are meant", text, usual, text));
  }
  return parse_length(text);
}

}  // namespace krok
