#include "draw/chart_style_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/text.h"

namespace krok::draw {

int motion_colour(std::size_t place) {
  // Distinct from the colours of the sides; the first is black.
  constexpr std::array kColours = {6, 3, 2, 5, 1};
  return kColours[place % kColours.size()];
}

std::vector<double> times_of(const ChartedMotion& motion) {
  std::vector<double> times;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    times.push_back(f / motion.clip->rate);
  }
  return times;
}

Panel time_panel(std::span<const ChartedMotion> motions, std::string title, std::string label,
                 std::string unit) {
  Panel panel;
  panel.title = std::move(title);
  panel.legend = false;
  panel.x = {"time", "s"};
  panel.y.label = std::move(label);
  panel.y.unit = std::move(unit);
  double low = INFINITY, high = -INFINITY;
  for (const ChartedMotion& motion : motions) {
    if (motion.frames.first > motion.frames.last) continue;
    low = std::min(low, motion.frames.first / motion.clip->rate);
    high = std::max(high, motion.frames.last / motion.clip->rate);
  }
  if (low < high) {
    panel.x.low = low;
    panel.x.high = high;
  }
  return panel;
}

Series motion_line(const ChartedMotion& motion, std::size_t place, std::vector<double> values) {
  Series series;
  series.name = motion.name;
  series.x = times_of(motion);
  series.y = std::move(values);
  series.colour = motion_colour(place);
  series.dash = static_cast<int>(place);
  return series;
}

Series side_line(const ChartedMotion& motion, std::size_t place, Side side,
                 std::vector<double> values) {
  Series series = motion_line(motion, place, std::move(values));
  series.name = fmt::format("{}, {}", side == Side::left ? "left" : "right", motion.name);
  series.colour = side_colour(side);
  return series;
}

std::vector<LegendEntry> motion_legend(std::span<const ChartedMotion> motions,
                                       std::span<const Panel> panels) {
  std::vector<LegendEntry> legend;
  for (const Panel& panel : panels) {
    if (panel.legend) continue;
    for (const Series& series : panel.series) {
      if (series.name.empty() || series.style == SeriesStyle::points) continue;
      const bool side = series.colour == kLeftColour || series.colour == kRightColour;
      if (motions.size() < 2 && !side) continue;
      const bool known = std::ranges::any_of(legend, [&](const LegendEntry& entry) {
        return entry.colour == series.colour && entry.dash == series.dash;
      });
      if (known) continue;
      LegendEntry entry{series.name, series.colour, series.dash};
      if (motions.size() < 2) entry.name = series.colour == kLeftColour ? "left" : "right";
      legend.push_back(std::move(entry));
    }
  }
  // Motion by motion, whatever panel comes first.
  std::ranges::stable_sort(legend, {}, &LegendEntry::dash);
  return legend;
}

Side side_of_foot(const ChartedMotion& motion, int joint) {
  while (joint >= 0) {
    switch (motion.roles->roles[static_cast<std::size_t>(joint)]) {
      case Role::left_foot:
      case Role::left_toes:
        return Side::left;
      case Role::right_foot:
      case Role::right_toes:
        return Side::right;
      default:
        joint = motion.clip->skeleton.parents[static_cast<std::size_t>(joint)];
    }
  }
  return Side::middle;
}

void add_keys(std::span<const ChartedMotion> motions, bool names, Panel& panel) {
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const ChartedMotion& motion = motions[m];
    const double first = motion.frames.first / motion.clip->rate;
    const double last = motion.frames.last / motion.clip->rate;
    const std::string number = motions.size() > 1 ? fmt::format("{}", m + 1) : "";
    for (const Side side : {Side::right, Side::left}) {
      const auto lane = static_cast<int>(panel.lanes.size());
      bool any = false;
      for (const Contact& contact : motion.keys.contacts) {
        if (side_of_foot(motion, contact.joint) != side) continue;
        any = true;
        const double from = std::max(contact.start, first), to = std::min(contact.end, last);
        if (from <= to) panel.spans.push_back({from, to, lane, side_colour(side)});
      }
      if (any) panel.lanes.push_back((side == Side::left ? "L" : "R") + number);
    }
    for (const Keytime& key : motion.keys.keytimes) {
      if (key.time < first || key.time > last) continue;
      panel.moments.push_back({key.time, names ? key.name : std::string()});
    }
  }
}

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
