#pragma once

#include <cstddef>
#include <string_view>

#include "core/text.h"

namespace krok::bvh {

// Splits a text into words. A brace is always a separate word.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text, std::size_t position = 0)
      : text_(text), position_(position) {}

  std::size_t position() const { return position_; }
  void seek(std::size_t position) { position_ = position; }
  bool at_end() const { return position_ >= text_.size(); }

  void skip_space();
  // Skips white space up to the end of the line.
  void skip_blanks();

  // The next word, empty at the end. word_begin() is its offset.
  std::string_view word();
  // The next word, without consuming it.
  std::string_view peek();
  std::size_t word_begin() const { return word_begin_; }

  // The next word if it is on this line, else empty; and whether it begins with `start`.
  std::string_view word_on_line();
  bool on_line(std::string_view start);

  // Consumes `expected` (case-insensitive) if it is the next token after white space.
  bool accept(std::string_view expected);

  // The rest of the line as a name: trimmed, up to a '{' at the end of the line or after white
  // space.
  std::string_view name();

  // The rest of the line, without the line end.
  std::string_view line();

  // The rest of the line, up to the first '{'.
  std::string_view to_brace();

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t word_begin_ = 0;
};

}  // namespace krok::bvh
