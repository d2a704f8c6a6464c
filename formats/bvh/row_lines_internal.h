#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// The lines after the motion header, split into words for the careful search for rows.

namespace krok::bvh {

// A non-empty line.
struct Line {
  std::size_t begin = 0;    // offset of the first word
  std::uint32_t words = 0;  // number of words
  bool numbers = true;      // all words are complete, finite numbers
  bool glued = false;       // a word is several numbers without a blank between them
  bool text = false;        // the first word is not even the beginning of a number
};

// All non-empty lines from byte `begin` on.
std::vector<Line> split_lines(std::string_view text, std::size_t begin);

// The word at `at` up to white space.
std::string_view word_at(std::string_view text, std::size_t at);

// Whether the complete word is a number that is valid in a row.
bool is_number(std::string_view word);

}  // namespace krok::bvh
