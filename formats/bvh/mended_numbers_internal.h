#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace krok::bvh {

// A text with its numbers written in the way that the reader takes.
struct MendedText {
  std::string text;
  std::size_t first = 0;  // offset of the first change, in the original
  std::size_t count = 0;  // words that were changed
};

// Some programs print numbers in the user's locale, such as 0,0333. These with a point instead of
// the comma; offsets are unchanged. nullopt if no word is such a number, or if other numbers have a
// point, so that commas may mean something else.
std::optional<MendedText> with_decimal_points(std::string_view text);

// Some programs put no blank before a sign: 0.0-7.5094748. The number of numbers in such a word, 0
// for any other.
std::size_t glued_numbers(std::string_view word);

// `text` with a blank between such numbers in rows and OFFSETs, which changes columns but no lines;
// nullopt if there are none.
std::optional<MendedText> with_split_numbers(std::string_view text);

}  // namespace krok::bvh
