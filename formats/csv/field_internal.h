#pragma once

#include <string>
#include <string_view>

namespace krok::csv {

// A text field, quoted if it has to be.
inline std::string field(std::string_view name) {
  if (name.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(name);
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + '"';
}

}  // namespace krok::csv
