#pragma once

#include <string>
#include <string_view>

#include "core/text.h"

namespace krok::csv {

// Whether a spreadsheet would run `text` as a formula (OWASP, CSV Injection), apostrophes at its
// begin aside. The writer puts an apostrophe before such names, and the table takes one away.
inline bool is_formula(std::string_view text) {
  const std::size_t at = text.find_first_not_of('\'');
  return at != std::string_view::npos &&
         std::string_view("=+-@\t\r").find(text[at]) != std::string_view::npos;
}

// A text field: printable, no formula to a spreadsheet, quoted if it has to be.
inline std::string field(std::string_view given) {
  std::string name;
  if (is_formula(given)) name += '\'';
  name += printable(given, true);
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + '"';
}

}  // namespace krok::csv
