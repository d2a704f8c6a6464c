#include "formats/bvh/row_lines_internal.h"

#include <limits>

#include <fmt/format.h>

#include "core/numbers.h"
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

Error RowFaults::error_at(std::size_t offset, std::string code, std::string message) {
  Error error(std::move(code), std::move(message));
  error.where = locate_(offset);
  return error;
}

Error RowFaults::number_fault(std::size_t begin) {
  std::size_t at = begin;
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    const std::string_view word = word_at(text_, at);
    if (!is_number(word)) return number_fault_at(word, at, channel);
    at += word.size();
    while (at < text_.size() && is_space(text_[at])) ++at;
  }
  return error_at(begin, "bvh-number", "a value is not a number");
}

Error RowFaults::number_fault_at(std::string_view word, std::size_t at, std::size_t channel) {
  const std::size_t glued = glued_numbers(word);
  const std::string what = glued > 0 ? fmt::format("{} numbers without a blank between them", glued)
                           : parse_finite(word) ? "too large"
                                                : "not a finite number";
  Error error =
      error_at(at, "bvh-number",
               fmt::format("'{}' is {} ({})", shown(word), what, hierarchy_.channel_name(channel)));
  error.hint = hint_for(word);
  error.joint =
      hierarchy_.joints[static_cast<std::size_t>(hierarchy_.channels[channel].joint)].name;
  return error;
}

const char* RowFaults::hint_for(std::string_view word) {
  const auto has = [&](std::string_view part) { return word.find(part) != word.npos; };
  if (glued_numbers(word) > 0) return "--repair splits them";
  const std::size_t comma = word.find(',');
  const bool one = comma != word.npos && word.find(',', comma + 1) == word.npos;
  if (one && comma + 1 < word.size() && !has(".")) {
    return "numbers are written with a decimal point; --repair reads decimal commas where no "
           "number has a point";
  }
  if (comma != word.npos || has(";") || has("\xC2\xA0")) {
    return "only blanks, tabs and line ends separate values";
  }
  return "--repair interpolates the frame from its neighbours";
}

Error RowFaults::length_fault(const Line& line) {
  if (line.words < channels_) {
    std::size_t end = line.begin;
    while (end < text_.size() && !is_line_end(text_[end])) ++end;
    return short_fault(line.begin, end, line.words);
  }
  std::size_t at = line.begin;
  for (std::size_t i = 0; i < channels_; ++i) {
    at += word_at(text_, at).size();
    while (at < text_.size() && is_space(text_[at])) ++at;
  }
  return error_at(at, "bvh-channel-count",
                  fmt::format("{}, expected {}", counted(line.words, "value"), channels_));
}

Error RowFaults::short_fault(std::size_t begin, std::size_t end, std::size_t values) {
  while (end > begin && is_space(text_[end - 1])) --end;
  const std::size_t missing = channels_ - values;
  return error_at(end, "bvh-channel-count",
                  fmt::format("{}, expected {} (missing: {}{})",
                              counted(static_cast<long long>(values), "value"), channels_,
                              hierarchy_.channel_name(values),
                              missing == 1 ? "" : fmt::format(" and {} more", missing - 1)));
}

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
