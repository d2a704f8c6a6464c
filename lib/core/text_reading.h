#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"

// What readers of text formats need of text, independent of the locale.

namespace krok {

// `c` in lower case if it is an ASCII letter, otherwise itself.
constexpr char ascii_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
std::string ascii_lower(std::string_view text);

// Whether two texts are the same but for the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

// Line and column of a byte; lines end with LF, CR LF or a lone CR. Takes time with the offset, so
// it is for messages.
Location locate(std::string_view text, std::size_t offset, const std::string& file_name);

// `text` itself if it is UTF-8, otherwise its bytes read as Latin-1.
std::string to_utf8(std::string_view text);

// For messages: UTF-8, without control characters, cut after about 40 bytes.
std::string shown(std::string_view text);

}  // namespace krok
