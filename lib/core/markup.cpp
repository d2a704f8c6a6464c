#include "core/markup.h"

#include "core/text.h"

namespace krok {

std::string to_markup(std::string_view text) {
  // U+FFFE and U+FFFF are the only characters above the control characters that XML does not allow.
  const auto is_no_character = [](std::string_view rest) {
    return rest.substr(0, 3) == "\xEF\xBF\xBE" || rest.substr(0, 3) == "\xEF\xBF\xBF";
  };
  const std::string safe = printable(to_utf8(text), true);
  std::string result;
  for (std::size_t i = 0; i < safe.size(); ++i) {
    const char c = safe[i];
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (is_no_character(std::string_view(safe).substr(i))) {
          result += '?';
          i += 2;
        } else {
          result += c;
        }
    }
  }
  return result;
}

}  // namespace krok
