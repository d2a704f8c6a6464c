#pragma once

#include <cstddef>
#include <string_view>

#include "core/text.h"

namespace krok::bvh {

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

  // The next word if it stands on this line, empty otherwise; and whether that begins with `start`.
  std::string_view word_on_line();
  bool on_line(std::string_view start);

  // Steps over `expected` (any case) if it stands next, after white space.
  bool accept(std::string_view expected);

  // The rest of the line as a name: trimmed, up to a '{' that ends the line or follows white space.
  std::string_view name();

  // The rest of the line, without its end.
  std::string_view line();

  // The rest of the line up to any '{'.
  std::string_view to_brace();

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t word_begin_ = 0;
};

}  // namespace krok::bvh
