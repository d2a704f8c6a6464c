#include <algorithm>

#include "core/text.h"
#include "formats/bvh/row_lines_internal.h"

namespace krok::bvh {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Offset of the only comma or point of a number; npos for any other word.
std::size_t mark_of(std::string_view word) {
  std::size_t mark = std::string_view::npos;
  bool digits = false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const char c = word[i];
    if (is_digit(c)) {
      digits = true;
    } else if (c == '-' || c == '+') {
      if (i != 0 && ascii_lower(word[i - 1]) != 'e') return std::string_view::npos;
    } else if (ascii_lower(c) == 'e') {
      if (!digits) return std::string_view::npos;
    } else if ((c == ',' || c == '.') && mark == std::string_view::npos) {
      mark = i;
    } else {
      return std::string_view::npos;
    }
  }
  // "1," is a number and a separator.
  const bool fraction = mark + 1 < word.size() && is_digit(word[mark + 1]);
  return digits && mark != std::string_view::npos && fraction ? mark : std::string_view::npos;
}

// Offset of the first sign after `from` that begins another number; the word's size if none does.
std::size_t next_number(std::string_view word, std::size_t from) {
  std::size_t i = from + 1;
  while (i < word.size() && ((word[i] != '-' && word[i] != '+') || ascii_lower(word[i - 1]) == 'e'))
    ++i;
  return std::min(i, word.size());
}

}  // namespace

std::optional<MendedText> with_decimal_points(std::string_view text) {
  if (text.find(',') == std::string_view::npos) return std::nullopt;
  MendedText result;
  for (std::size_t at = 0; at < text.size();) {
    if (is_space(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_space(text[end])) ++end;
    const std::size_t mark = mark_of(text.substr(at, end - at));
    if (mark != std::string_view::npos) {
      if (text[at + mark] == '.') return std::nullopt;
      if (result.count++ == 0) {
        result.first = at + mark;
        result.text = text;
      }
      result.text[at + mark] = '.';
    }
    at = end;
  }
  if (result.count == 0) return std::nullopt;
  return result;
}

std::size_t glued_numbers(std::string_view word) {
  std::size_t count = 0;
  for (std::size_t begin = 0, end = 0; begin < word.size(); begin = end, ++count) {
    end = next_number(word, begin);
    if (end - begin == word.size() || !is_number(word.substr(begin, end - begin))) return 0;
  }
  return count;
}

std::optional<MendedText> with_split_numbers(std::string_view text) {
  const auto glued = [](char a, char b) {
    return (b == '-' || b == '+') && (is_digit(a) || a == '.');
  };
  if (std::adjacent_find(text.begin(), text.end(), glued) == text.end()) return std::nullopt;
  MendedText result;
  std::size_t copied = 0;  // of `text`
  for (const Line& line : split_lines(text, 0)) {
    std::size_t at = line.begin;
    if (!line.glued || (line.text && !same_word(word_at(text, at), "OFFSET"))) continue;
    for (std::uint32_t k = 0; k < line.words; ++k) {
      const std::string_view word = word_at(text, at);
      if (glued_numbers(word) > 0 && result.count++ == 0) result.first = at;
      for (std::size_t i = 0; glued_numbers(word) > 0 && i < word.size();) {
        i = next_number(word, i);
        result.text.append(text, copied, at + i - copied).push_back(' ');
        copied = at + i;
      }
      at += word.size();
      while (at < text.size() && is_space(text[at])) ++at;
    }
  }
  if (result.count == 0) return std::nullopt;
  result.text.append(text, copied);
  return result;
}

}  // namespace krok::bvh
