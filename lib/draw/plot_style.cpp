#include "draw/plot_style_internal.h"

#include <fmt/format.h>
#include <vector>

#include "core/text.h"

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

namespace {

constexpr double kSample = 24;  // length of the line
constexpr double kBeforeText = 30;
constexpr double kAfterText = 14;

std::string sample_of(const LegendEntry& entry, double left, double middle) {
  const auto place = static_cast<std::size_t>(entry.colour);
  const std::string& colour = palette_colour(place);
  std::string sample = entry.faint ? "<g opacity=\"0.4\">" : "";
  if (entry.style != SeriesStyle::points) {
    const std::string dash = dash_pattern(entry.dash, place);
    sample += fmt::format("<path class=\"line\" stroke=\"{}\"{} d=\"M{} {}h{}\"/>", colour,
                          dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dash),
                          number(left), number(middle), number(kSample));
  }
  if (entry.style != SeriesStyle::line) {
    sample += fmt::format("<circle fill=\"{}\" cx=\"{}\" cy=\"{}\" r=\"2.4\"/>", colour,
                          number(left + kSample / 2), number(middle));
  }
  return entry.faint ? sample + "</g>" : sample;
}

}  // namespace

std::vector<LegendEntry> legend_of(const Panel& panel) {
  std::vector<LegendEntry> entries;
  if (!panel.legend) return entries;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    if (series.name.empty()) continue;
    entries.push_back({series.name, series.colour >= 0 ? series.colour : static_cast<int>(i),
                       series.dash, series.style, series.faint});
  }
  return entries;
}

double write_legend(const std::vector<LegendEntry>& entries, double left, double top, double width,
                    std::string* out) {
  if (entries.empty()) return 0.0;
  double x = 0.0, y = 0.0;
  for (const LegendEntry& entry : entries) {
    const std::string name = shortened(entry.name, width - kBeforeText);
    const double room = kBeforeText + text_width(name) + kAfterText;
    if (x > 0 && x + room > width) {
      x = 0;
      y += kTextSize + 5;
    }
    if (out != nullptr) {
      *out += sample_of(entry, left + x, top + y + kTextSize * 0.6);
      *out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", number(left + x + kBeforeText),
                          number(top + y + kTextSize), to_markup(name));
    }
    x += room;
  }
  return y + kTextSize + 8;
}

}  // namespace krok::draw
