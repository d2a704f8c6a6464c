#include "formats/bvh/row_lines_internal.h"

#include <limits>

#include "core/text.h"
#include "formats/bvh/mended_numbers_internal.h"
#include "formats/bvh/motion_rows.h"

namespace krok::bvh {

namespace {

// A line that begins with neither a number nor nan or inf is not a row of numbers.
bool begins_like_text(std::string_view word) {
  const auto c = static_cast<unsigned char>(word.front());
  if ((c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+') return false;
  for (const std::string_view number : {"nan", "inf"}) {
    if (same_word(word.substr(0, 3), number)) return false;
  }
  return true;
}

}  // namespace

std::string_view word_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && !is_space(text[end])) ++end;
  return text.substr(at, end - at);
}

bool is_number(std::string_view word) {
  double value = 0;
  return parse_row(word, 0, {&value, 1}) == word.size();
}

std::vector<Line> split_lines(std::string_view text, std::size_t begin) {
  std::vector<Line> lines;
  std::size_t at = begin;
  while (at < text.size()) {
    Line line;
    while (at < text.size() && !is_line_end(text[at])) {
      if (is_space(text[at])) {
        ++at;
        continue;
      }
      const std::string_view word = word_at(text, at);
      if (line.words == 0) {
        line.begin = at;
        line.text = begins_like_text(word);
      }
      if (line.words < std::numeric_limits<std::uint32_t>::max()) ++line.words;
      if (!is_number(word)) {
        line.numbers = false;
        line.glued = line.glued || glued_numbers(word) > 0;
      }
      at += word.size();
    }
    if (line.words > 0) lines.push_back(line);
    while (at < text.size() && is_line_end(text[at])) ++at;
  }
  return lines;
}

}  // namespace krok::bvh
