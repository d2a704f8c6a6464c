#include "draw/svg_text_internal.h"

#include <fmt/format.h>

#include <vector>

#include "draw/plot_style_internal.h"

namespace krok::draw {

namespace {

bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

// CJK characters, from U+2E80 on, count as twice as wide.
double width_of(std::string_view character) {
  const bool wide = static_cast<unsigned char>(character[0]) >= 0xE3 ||
                    (character[0] == '\xE2' && character.size() > 1 &&
                     static_cast<unsigned char>(character[1]) >= 0xBA);
  return wide ? 2 * kCharacter : kCharacter;
}

// The characters of a text, as UTF-8 sequences.
std::vector<std::string_view> characters_of(std::string_view text) {
  std::vector<std::string_view> characters;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at + 1;
    while (end < text.size() && continues_character(text[end])) ++end;
    characters.push_back(text.substr(at, end - at));
    at = end;
  }
  return characters;
}

}  // namespace

std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

double text_width(std::string_view text) {
  double width = 0;
  for (const std::string_view character : characters_of(text)) width += width_of(character);
  return width;
}

std::string shortened(const std::string& text, double width) {
  if (text_width(text) <= width) return text;
  const auto characters = characters_of(text);
  // File names of one series differ at the end, so the end gets as much space as the beginning.
  std::string begin, end;
  double room = width - kCharacter;
  for (std::size_t i = 0; i < characters.size() / 2; ++i) {
    const std::string_view last = characters[characters.size() - 1 - i];
    room -= width_of(characters[i]) + width_of(last);
    if (room < 0) break;
    begin += characters[i];
    end.insert(0, last);
  }
  return begin + "\u2026" + end;
}

}  // namespace krok::draw
