#include "draw/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "draw/plot_panel_internal.h"
#include "draw/plot_style_internal.h"

namespace krok::draw {

namespace {

// Space around the plot area of a panel.
constexpr double kLeft = 66, kRight = 16, kTop = 28, kBottom = 48;
constexpr double kMargin = 16;  // of the chart's own title and legend

constexpr const char* kStyle =
    "<style>text{font:12px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#222}"
    ".title{font-size:14px;font-weight:600}.small{font-size:10px;fill:#555}"
    ".grid{stroke:#e2e5e9;stroke-width:1}.frame{fill:none;stroke:#7b8794;stroke-width:1}"
    ".line{fill:none;stroke-width:1.6;stroke-linejoin:round}"
    ".name{paint-order:stroke;stroke:#fff;stroke-width:3px}"
    ".moment{stroke:#555;stroke-width:1;stroke-dasharray:3 3}.paper{fill:#fff}"
    "@media (prefers-color-scheme:dark){text{fill:#e4e7eb}.small{fill:#a3abb4}"
    ".paper{fill:#16191d}.grid{stroke:#2c3238}.frame{stroke:#6b7580}.name{stroke:#16191d}"
    ".moment{stroke:#a3abb4}[stroke='#000000']{stroke:#e4e7eb}[fill='#000000']{fill:#e4e7eb}"
    "[stroke='#0072b2']{stroke:#4aa3df}[fill='#0072b2']{fill:#4aa3df}}</style>\n";

Status check_chart(const Chart& chart) {
  if (chart.panels.empty()) return Error("plot-empty", "a chart needs at least one panel");
  const auto is_length = [](double length) { return length >= 1 && length <= 1e5; };
  if (!is_length(chart.panel_width) || !is_length(chart.panel_height)) {
    return Error("plot-size", "panel width and height must be 1 to 100,000 pixels");
  }
  for (const Panel& panel : chart.panels) {
    for (const Axis* axis : {&panel.x, &panel.y}) {
      if (Status status = check_axis(*axis); !status) return status;
    }
    if (panel.field) {
      if (Status status = check_field(*panel.field); !status) return status;
    }
    for (const Series& series : panel.series) {
      if (series.x.size() != series.y.size()) {
        return Error("plot-shape", fmt::format("the series '{}' has {} x values and {} y values",
                                               series.name, series.x.size(), series.y.size()));
      }
    }
  }
  return {};
}

// Writes the panels row by row from `y` downwards; returns the lower edge.
double write_panels(const Chart& chart, int columns, double y, std::string& body) {
  const double cell_width = kLeft + chart.panel_width + kRight;
  for (std::size_t first = 0; first < chart.panels.size();) {
    double legend_room = 0;
    const std::size_t end =
        std::min(chart.panels.size(), first + static_cast<std::size_t>(columns));
    for (std::size_t i = first; i < end; ++i) {
      legend_room = std::max(
          legend_room, write_legend(legend_of(chart.panels[i]), 0, 0, chart.panel_width, nullptr));
    }
    for (std::size_t i = first; i < end; ++i) {
      const double left = kLeft + static_cast<double>(i - first) * cell_width;
      const double top = y + kTop;
      PanelWriter(chart.panels[i], left, top, chart.panel_width, chart.panel_height,
                  static_cast<int>(i), body)
          .write();
      write_legend(legend_of(chart.panels[i]), left, top + chart.panel_height + kBottom - 6,
                   chart.panel_width, &body);
    }
    y += kTop + chart.panel_height + kBottom + legend_room;
    first = end;
  }
  return y;
}

}  // namespace

const std::vector<std::string>& palette() {
  // Okabe and Ito, Color Universal Design (2008): distinct for colour-blind readers too. Their
  // yellow is left out, because it is invisible on white paper; black comes last.
  static const std::vector<std::string> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                   "#e69f00", "#56b4e9", "#000000"};
  return colours;
}

const std::string& palette_colour(std::size_t place) {
  return palette()[place % palette().size()];
}

const char* dash_pattern(int dash, std::size_t place) {
  constexpr const char* kDashes[] = {"", "6 3", "2 2", "8 3 2 3", "12 4", "1 3"};
  const std::size_t which = dash < 0 ? place : static_cast<std::size_t>(dash);
  return kDashes[which % std::size(kDashes)];
}

Result<std::string> to_svg(const Chart& chart) {
  if (Status status = check_chart(chart); !status) return status.error();
  const int columns = std::max(1, std::min(chart.columns, static_cast<int>(chart.panels.size())));
  const double full_width = (kLeft + chart.panel_width + kRight) * columns;

  std::string body;
  double y = 0;
  if (!chart.title.empty()) {
    const double room = (full_width - 2 * kMargin) * kTextSize / kChartTitleSize;
    body += fmt::format(
        "<text class=\"title\" style=\"font-size:16px\" x=\"16\" "
        "y=\"22\">{}</text>\n",
        to_markup(shortened(chart.title, room)));
    y += kTitleSize + 14;
  }
  y += write_legend(chart.legend, kMargin, y + 2, full_width - 2 * kMargin, &body);
  y = write_panels(chart, columns, y, body);

  const std::string width = number(full_width);
  const std::string height = number(y);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\" role=\"img\">\n",
      width, height);
  if (!chart.title.empty()) svg += fmt::format("<title>{}</title>\n", to_markup(chart.title));
  svg += kStyle;
  svg += fmt::format("<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n", width, height);
  svg += body;
  svg += "</svg>\n";
  return svg;
}

}  // namespace krok::draw
