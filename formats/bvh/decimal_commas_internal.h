#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace krok::bvh {

// A text with decimal commas replaced by points; offsets are unchanged.
struct PointedText {
  std::string text;
  std::size_t first = 0;  // offset of the first comma
  std::size_t count = 0;  // numbers with a decimal comma
};

// Some programs print numbers in the user's locale, such as 0,0333. nullopt if no word is such a
// number, or if other numbers have a point, so that commas may mean something else.
std::optional<PointedText> with_decimal_points(std::string_view text);

}  // namespace krok::bvh
