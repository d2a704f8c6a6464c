#include "core/text.h"
#include "formats/bvh/decimal_commas_internal.h"

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

}  // namespace

std::optional<PointedText> with_decimal_points(std::string_view text) {
  if (text.find(',') == std::string_view::npos) return std::nullopt;
  PointedText result;
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

}  // namespace krok::bvh
