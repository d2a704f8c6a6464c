#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace krok::bvh {

// A text whose numbers had decimal commas, with points in their place; all else stands where it
// stood.
struct PointedText {
  std::string text;
  std::size_t first = 0;  // the byte of the first comma
  std::size_t count = 0;  // how many numbers had one
};

// Programs that print numbers as their user's country writes them give 0,0333. Nothing where no
// word is such a number, or where others have a point, so that a comma may mean something else.
std::optional<PointedText> with_decimal_points(std::string_view text);

}  // namespace krok::bvh
