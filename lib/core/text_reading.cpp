#include "core/text_reading.h"

#include <algorithm>

#include "core/text.h"

namespace krok {

std::string ascii_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = ascii_lower(c);
  return lower;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return ascii_lower(x) == ascii_lower(y); });
}

Location locate(std::string_view text, std::size_t offset, const std::string& file_name) {
  offset = std::min(offset, text.size());
  const std::string_view before = text.substr(0, offset);
  std::int64_t line = 1;
  std::size_t line_begin = 0;
  for (std::size_t end = before.find_first_of("\r\n"); end != std::string_view::npos;
       end = before.find_first_of("\r\n", end + 1)) {
    // A CR LF counts at its LF, which may stand after `offset`.
    if (text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n') continue;
    ++line;
    line_begin = end + 1;
  }
  Location where;
  where.file = file_name;
  where.line = line;
  where.column = static_cast<std::int64_t>(offset - line_begin) + 1;
  return where;
}

std::string to_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string utf8;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (code >> 6));
      utf8 += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return utf8;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::size_t length = std::min(text.size(), kMost);
  // Not in the middle of a character.
  while (length < text.size() && length > kMost - 4 &&
         (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) {
    --length;
  }
  std::string result = to_utf8(text.substr(0, length));
  for (char& c : result) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F) c = '?';
  }
  return length < text.size() ? result + "..." : result;
}

}  // namespace krok
