#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace krok::bvh {

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

// Whether two ASCII texts are the same but for case.
bool same_word(std::string_view a, std::string_view b);

// `text` without white space at its ends.
std::string_view trimmed(std::string_view text);

// Lines and columns of bytes, lines ended by LF, CR LF or a lone CR. Going forward costs one look
// at each byte in all, going back starts anew.
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

// Steps through a text by words. Braces are words of their own wherever they stand.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text, std::size_t position = 0)
      : text_(text), position_(position) {}

  std::size_t position() const { return position_; }
  void seek(std::size_t position) { position_ = position; }
  bool at_end() const { return position_ >= text_.size(); }

  void skip_space();
  // Skips white space that stays on the line.
  void skip_blanks();

  // The next word, empty at the end. word_begin() is where it stands.
  std::string_view word();
  // The next word without stepping over it.
  std::string_view peek();
  std::size_t word_begin() const { return word_begin_; }

  // Steps over `expected` (any case) if it stands next, after white space.
  bool accept(std::string_view expected);

  // The rest of the line as a name: trimmed, up to a '{' that ends the line or follows white space.
  std::string_view name();

  // The rest of the line up to any '{'.
  std::string_view to_brace();

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t word_begin_ = 0;
};

}  // namespace krok::bvh
