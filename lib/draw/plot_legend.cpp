#include "draw/plot_legend_internal.h"

#include <fmt/format.h>

#include "core/markup.h"
#include "draw/plot_style_internal.h"
#include "draw/svg_text_internal.h"

namespace krok::draw {

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
