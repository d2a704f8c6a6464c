#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// The lines between the motion's header and the end of a file, as the careful search for rows sees
// them.

namespace krok::bvh {

// A line that is not empty.
struct Line {
  std::size_t begin = 0;    // its first word
  std::uint32_t words = 0;  // how many
  bool numbers = true;      // all of them whole, finite numbers
  bool text = false;        // the first one is not even the beginning of a number
};

// All lines that are not empty from byte `begin` on.
std::vector<Line> split_lines(std::string_view text, std::size_t begin);

// The word at `at` up to white space.
std::string_view word_at(std::string_view text, std::size_t at);

// Whether the whole of a word is a number that a row may have.
bool is_number(std::string_view word);

}  // namespace krok::bvh
