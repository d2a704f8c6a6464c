#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

// Text functions for readers of text formats, independent of the locale.

namespace krok {

inline constexpr std::array<bool, 256> kIsSpace = [] {
  std::array<bool, 256> table{};
  for (const unsigned char c : {' ', '\t', '\r', '\n', '\v', '\f'}) table[c] = true;
  return table;
}();

inline bool is_space(char c) {
  return kIsSpace[static_cast<unsigned char>(c)];
}
inline bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

// `text` without leading and trailing white space.
std::string_view trimmed(std::string_view text);

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
std::string_view without_byte_order_mark(std::string_view text);

// `c` in lower case if it is an ASCII letter, otherwise itself.
constexpr char ascii_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
std::string ascii_lower(std::string_view text);

// Whether two texts are equal, ignoring the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

// Converts byte offsets to lines and columns, for messages; lines end with LF, CR LF or a lone CR.
// Increasing offsets scan each byte once, going back starts over. An offset beyond the text is its
// end. Both arguments must outlive the locator.
class Locator {
 public:
  Locator(std::string_view text, const std::string& file_name)
      : text_(text), file_name_(file_name) {}

  Location operator()(std::size_t offset);

 private:
  std::string_view text_;
  const std::string& file_name_;
  std::size_t at_ = 0;
  std::size_t line_begin_ = 0;
  std::int64_t line_ = 1;
};

// The location of one byte. Takes time linear in the offset.
Location locate(std::string_view text, std::size_t offset, const std::string& file_name);

// Whether `text` is well-formed UTF-8 (RFC 3629): no stray or missing continuation bytes, no
// overlong forms, no surrogates, nothing above U+10FFFF. Empty text is valid.
bool is_utf8(std::string_view text);

inline constexpr char32_t kReplacementCharacter = 0xFFFD;

// The characters of UTF-8 text; kReplacementCharacter for each byte that is not part of one.
std::u32string code_points(std::string_view text);
// Appends a character; kReplacementCharacter for what is none.
void append_utf8(char32_t character, std::string& text);

// Whether `text` is valid as a name: UTF-8 without zero bytes, 1 to kLongestName bytes.
inline constexpr std::size_t kLongestName = 1000;
bool is_name(std::string_view text);

// `text` itself if it is UTF-8, otherwise its bytes read as Latin-1.
std::string to_utf8(std::string_view text);

// For terminals: `text`, which is UTF-8, with '?' in place of control characters (names in files
// may be escape sequences), U+0080 to U+009F among them, and of those that change the direction of
// text. With `lines`, line ends and tabs stay.
std::string printable(std::string_view text, bool lines = false);

// For messages: UTF-8, printable, truncated after about 40 bytes.
std::string shown(std::string_view text);

// Base64 (RFC 4648) with padding. Data encoded in pieces gives the same text as a whole if all
// pieces but the last have a multiple of three bytes.
std::string to_base64(std::span<const std::byte> bytes);

// `text` for XML and HTML, including attributes: UTF-8, with &, <, > and " escaped and '?' in place
// of what printable() replaces (see core/text.h) and of characters that XML does not allow.
std::string to_markup(std::string_view text);

// The one of `names` with the smallest edit distance (Levenshtein, with exchanged letters as one
// edit) to `word`, ignoring case; the first of equally near ones. Empty if none is near, that is
// within the larger of two letters and a third of the longer word, and one letter or less than half
// of it (without dashes before it). Only the first 64 bytes are compared.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

// A hint for a word that is not in `names`: "did you mean 'walk'?" if one is near, otherwise
// "expected one of walk, run".
std::string nearest_hint(std::string_view word, std::span<const std::string> names);

}  // namespace krok
