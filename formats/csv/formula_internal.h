#pragma once

#include <string_view>

namespace krok::csv {

// Whether a spreadsheet would run `text` as a formula (OWASP, CSV Injection), apostrophes at its
// begin aside. The writer puts an apostrophe before such names, and the table takes one away.
inline bool is_formula(std::string_view text) {
  const std::size_t at = text.find_first_not_of('\'');
  return at != std::string_view::npos &&
         std::string_view("=+-@\t\r").find(text[at]) != std::string_view::npos;
}

}  // namespace krok::csv
