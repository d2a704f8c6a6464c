#include "draw/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.h"
#include "draw/chart_style_internal.h"
#include "draw/plot_panel_internal.h"

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

double tick_step(double low, double high, int wanted) {
  const double least = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

namespace {

std::vector<double> linear_ticks(double low, double high, int wanted) {
  const double step = tick_step(low, high, wanted);
  std::vector<double> result;
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  // Multiplied, not accumulated, so that 0 is exact and ticks do not drift.
  for (double k = first; k <= last && result.size() < 1000; ++k) {
    result.push_back(k == 0 ? 0.0 : k * step);
  }
  return result;
}

std::vector<double> logarithmic_ticks(double low, double high, int wanted) {
  const double first = std::floor(std::log10(low) + 1e-9);
  const double last = std::ceil(std::log10(high) - 1e-9);
  const double decades = last - first;
  std::vector<double> result;
  const double every = std::max(1.0, std::ceil(decades / std::max(wanted, 1)));
  for (double power = first; power <= last; power += every) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1 && decades > 2) continue;
      const double value = factor * std::pow(10.0, power);
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)) result.push_back(value);
    }
  }
  return result.size() < 2 ? linear_ticks(low, high, wanted) : result;
}

}  // namespace

std::vector<double> ticks(double low, double high, int wanted, Scale scale) {
  return scale == Scale::linear ? linear_ticks(low, high, wanted)
                                : logarithmic_ticks(low, high, wanted);
}

namespace {

constexpr double kMin = 1e-250;       // smaller values count as 0 on an axis
constexpr double kSameValue = 1e-12;  // relative

// The smallest 1, 2 or 5 times a power of ten that is at least `value`; the inverses have the same
// form.
double round_up(double value) {
  return tick_step(0, value, 1);
}

}  // namespace

void Range::add(double value, Scale scale) {
  if (!can_show(value, scale)) return;
  if (scale == Scale::linear && std::abs(value) < kMin) value = 0;
  low = std::min(low, value);
  high = std::max(high, value);
}

Range Range::settled(Scale scale) const {
  if (!(low <= high)) return scale == Scale::linear ? Range{0.0, 1.0} : Range{1.0, 10.0};
  if (high - low > kSameValue * std::max(std::abs(low), std::abs(high))) return *this;
  const double around = low == 0 ? 1.0 : std::abs(low) * 0.5;
  return {low - around, high + around};
}

Status check_axis(const Axis& axis) {
  const bool bad = (axis.low && !std::isfinite(*axis.low)) ||
                   (axis.high && !std::isfinite(*axis.high)) ||
                   (axis.low && axis.high && *axis.low >= *axis.high) ||
                   (axis.scale == Scale::logarithmic &&
                    ((axis.low && *axis.low <= 0) || (axis.high && *axis.high <= 0)));
  if (!bad) return {};
  return Error("plot-axis", fmt::format("axis '{}': limits must be finite and increasing, and "
                                        "positive on a logarithmic axis",
                                        axis.label));
}

Mapping map_axis(const Axis& axis, const Range& values, int wanted) {
  Mapping mapping;
  mapping.scale = axis.scale;
  const auto [low, high] = values.settled(axis.scale);
  if (axis.scale == Scale::logarithmic) {
    mapping.low = axis.low.value_or(1 / round_up(1 / low));
    mapping.high = axis.high.value_or(round_up(high));
    if (mapping.high <= mapping.low) mapping.high = mapping.low * 10;
    return mapping;
  }
  const double step = tick_step(low, high, wanted);
  mapping.low = axis.low.value_or(std::floor(low / step + 1e-9) * step);
  mapping.high = axis.high.value_or(std::ceil(high / step - 1e-9) * step);
  if (mapping.high <= mapping.low) mapping.high = mapping.low + step;
  return mapping;
}

double step_of(const std::vector<double>& ticks) {
  double step = INFINITY;
  for (std::size_t i = 1; i < ticks.size(); ++i) step = std::min(step, ticks[i] - ticks[i - 1]);
  return std::isfinite(step) ? step : ticks.empty() ? 1.0 : std::max(std::abs(ticks[0]), 1e-9);
}

std::string tick_text(double value, double step, Scale scale) {
  if (scale == Scale::logarithmic) return fmt::format("{:.6g}", value);
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) {
    const int significant = static_cast<int>(std::ceil(std::log10(size / step) - 1e-9)) + 1;
    return fmt::format("{:.{}g}", value, std::clamp(significant, 3, 15));
  }
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text[0] == '-') text.replace(0, 1, "\u2212");  // a minus sign as wide as the digits
  return text;
}

std::string axis_title(const Axis& axis) {
  if (axis.label.empty() || axis.unit.empty()) return axis.label + axis.unit;
  return fmt::format("{} ({})", axis.label, axis.unit);
}

}  // namespace krok::draw
