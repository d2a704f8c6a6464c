#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

void TextCursor::skip_space() {
  while (position_ < text_.size() && is_space(text_[position_])) ++position_;
}

void TextCursor::skip_blanks() {
  while (position_ < text_.size() && is_space(text_[position_]) && !is_line_end(text_[position_])) {
    ++position_;
  }
}

std::string_view TextCursor::word() {
  skip_space();
  word_begin_ = position_;
  if (at_end()) return {};
  if (text_[position_] == '{' || text_[position_] == '}') {
    ++position_;
  } else {
    while (position_ < text_.size() && !is_space(text_[position_]) && text_[position_] != '{' &&
           text_[position_] != '}') {
      ++position_;
    }
  }
  return text_.substr(word_begin_, position_ - word_begin_);
}

std::string_view TextCursor::peek() {
  const std::size_t before = position_;
  const std::string_view next = word();
  position_ = before;
  return next;
}

std::string_view TextCursor::word_on_line() {
  skip_blanks();
  word_begin_ = position_;
  if (at_end() || is_line_end(text_[position_])) return {};
  return word();
}

bool TextCursor::on_line(std::string_view start) {
  skip_blanks();
  return text_.substr(position_).starts_with(start);
}

bool TextCursor::accept(std::string_view expected) {
  skip_space();
  if (!same_word(text_.substr(position_, expected.size()), expected)) return false;
  word_begin_ = position_;
  position_ += expected.size();
  return true;
}

std::string_view TextCursor::line() {
  word_begin_ = position_;
  while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
  return trimmed(text_.substr(word_begin_, position_ - word_begin_));
}

std::string_view TextCursor::to_brace() {
  word_begin_ = position_;
  while (position_ < text_.size() && !is_line_end(text_[position_]) && text_[position_] != '{') {
    ++position_;
  }
  return trimmed(text_.substr(word_begin_, position_ - word_begin_));
}

std::string_view TextCursor::name() {
  skip_blanks();
  word_begin_ = position_;
  std::size_t end = position_;
  while (end < text_.size() && !is_line_end(text_[end])) {
    if (text_[end] == '{') {
      const bool after_space = end == position_ || is_space(text_[end - 1]);
      std::size_t next = end + 1;
      while (next < text_.size() && is_space(text_[next]) && !is_line_end(text_[next])) ++next;
      if (after_space || next == text_.size() || is_line_end(text_[next])) break;
    }
    ++end;
  }
  const std::string_view name = trimmed(text_.substr(position_, end - position_));
  position_ = end;
  return name;
}

}  // namespace krok::bvh
