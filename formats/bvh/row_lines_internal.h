#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/text.h"
#include "formats/bvh/hierarchy.h"

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

// Builds error messages for invalid rows, with their location. All arguments must outlive this.
class RowFaults {
 public:
  RowFaults(std::string_view text, const Hierarchy& hierarchy, const std::string& file_name)
      : text_(text),
        hierarchy_(hierarchy),
        channels_(hierarchy.channels.size()),
        locate_(text, file_name) {}

  Error error_at(std::size_t offset, std::string code, std::string message);

  // The first invalid number in the row at `begin`, which has the expected number of values.
  Error number_fault(std::size_t begin);
  // `word` at byte `at`, the value of `channel`.
  Error number_fault_at(std::string_view word, std::size_t at, std::size_t channel);

  // A line with too many or too few values.
  Error length_fault(const Line& line);

  // `begin` .. `end` has `values` values, too few; the reported location is that of the next one.
  Error short_fault(std::size_t begin, std::size_t end, std::size_t values);

  // The hint for a word that is not a number.
  static const char* hint_for(std::string_view word);

 private:
  std::string_view text_;
  const Hierarchy& hierarchy_;
  const std::size_t channels_;
  Locator locate_;
};

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
