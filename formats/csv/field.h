#pragma once

#include <string>
#include <string_view>

#include "core/text.h"
#include "formats/csv/formula_internal.h"

namespace krok::csv {

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
