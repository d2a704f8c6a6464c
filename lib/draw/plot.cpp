#include "draw/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace krok::draw {

namespace {

// Lengths in CSS pixels.
constexpr double kTextSize = 12.0;
constexpr double kTitleSize = 14.0;
constexpr double kCharacter = 6.4;  // a digit's width at kTextSize in common sans-serif faces
constexpr double kLane = 7.0;
constexpr double kTick = 4.0;
constexpr double kThinning = 0.02;

// Stroke patterns beside the colours; the first lines are solid.
constexpr const char* kDashes[] = {"", "", "", "6 3", "2 2", "8 3 2 3", "12 4", "1 3"};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        // Other control characters are no XML.
        result += static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' ? ' ' : c;
    }
  }
  return result;
}

// A coordinate to a hundredth of a pixel, without trailing zeros.
std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

// A tick's value: as many digits as tell it from its neighbours, on a logarithmic axis its own.
std::string tick_text(double value, double step, Scale scale) {
  if (scale == Scale::logarithmic) return fmt::format("{:.6g}", value);
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) return fmt::format("{:.3g}", value);
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text[0] == '-') text.replace(0, 1, "\u2212");  // a minus sign as long as the digits
  return text;
}

std::string axis_title(const Axis& axis) {
  return axis.unit.empty() ? axis.label : fmt::format("{} ({})", axis.label, axis.unit);
}

// Where on an axis a value lies, from 0 to 1.
struct Mapping {
  double low = 0.0, high = 1.0;
  Scale scale = Scale::linear;

  double place(double value) const {
    if (scale == Scale::linear) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
  }
  bool shows(double value) const {
    return std::isfinite(value) && (scale == Scale::linear || value > 0);
  }
};

Status check_axis(const Axis& axis) {
  const bool bad = (axis.low && !std::isfinite(*axis.low)) ||
                   (axis.high && !std::isfinite(*axis.high)) ||
                   (axis.low && axis.high && *axis.low >= *axis.high) ||
                   (axis.scale == Scale::logarithmic &&
                    ((axis.low && *axis.low <= 0) || (axis.high && *axis.high <= 0)));
  if (!bad) return {};
  return Error("plot-axis", fmt::format("the limits of the axis '{}' do not rise, or are no "
                                        "numbers that it can show",
                                        axis.label));
}

// The limits given, or those of the values, rounded outwards to ticks.
Mapping map_axis(const Axis& axis, double low, double high, int wanted) {
  Mapping mapping;
  mapping.scale = axis.scale;
  if (!(low <= high)) {  // nothing to show
    low = axis.scale == Scale::linear ? 0.0 : 1.0;
    high = axis.scale == Scale::linear ? 1.0 : 10.0;
  }
  if (low == high) {  // one value: it stands in the middle
    const double around = low == 0 ? 1.0 : std::abs(low) * 0.5;
    low -= around;
    high += around;
  }
  if (axis.scale == Scale::logarithmic) {
    mapping.low = axis.low.value_or(std::pow(10.0, std::floor(std::log10(low) + 1e-9)));
    mapping.high = axis.high.value_or(std::pow(10.0, std::ceil(std::log10(high) - 1e-9)));
    if (mapping.high <= mapping.low) mapping.high = mapping.low * 10;
    return mapping;
  }
  const auto inner = ticks(low, high, wanted, Scale::linear);
  const double step = inner.size() > 1 ? inner[1] - inner[0] : high - low;
  mapping.low = axis.low.value_or(std::floor(low / step + 1e-9) * step);
  mapping.high = axis.high.value_or(std::ceil(high / step - 1e-9) * step);
  if (mapping.high <= mapping.low) mapping.high = mapping.low + step;
  return mapping;
}

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double value, Scale scale) {
    if (!std::isfinite(value) || (scale == Scale::logarithmic && value <= 0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

struct Point {
  double x, y;
};

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double along =
      square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

// Marks the points of a line that it needs to stay within kThinning of itself (Douglas and Peucker,
// 1973).
std::vector<std::uint8_t> thin(const std::vector<Point>& line) {
  std::vector<std::uint8_t> kept(line.size(), 0);
  if (line.empty()) return kept;
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = kThinning;
    std::size_t corner = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_to_segment(line[i], line[first], line[last]);
      if (distance > farthest) {
        farthest = distance;
        corner = i;
      }
    }
    if (corner == first) continue;
    kept[corner] = 1;
    open.emplace_back(first, corner);
    open.emplace_back(corner, last);
  }
  return kept;
}

// One panel on its way into the text.
class PanelWriter {
 public:
  PanelWriter(const Panel& panel, double left, double top, double width, double height, int id,
              std::string& out)
      : panel_(panel), left_(left), top_(top), width_(width), height_(height), id_(id), out_(out) {
    map();
  }

  void write() {
    frame();
    put("<g clip-path=\"url(#panel-{})\">\n", id_);
    for (const Span& span : panel_.spans) bar(span);
    for (const Moment& moment : panel_.moments) line_across(moment);
    for (std::size_t i = 0; i < panel_.series.size(); ++i) series(i);
    out_ += "</g>\n";
    for (const Moment& moment : panel_.moments) moment_name(moment);
  }

 private:
  template <typename... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
  }

  void map() {
    Range x, y;
    for (const Series& series : panel_.series) {
      for (std::size_t i = 0; i < series.x.size(); ++i) {
        x.add(series.x[i], panel_.x.scale);
        y.add(series.y[i], panel_.y.scale);
      }
    }
    for (const Span& span : panel_.spans) {
      x.add(span.from, panel_.x.scale);
      x.add(span.to, panel_.x.scale);
    }
    Axis along = panel_.x;
    // Time and the like fill the panel's width; a half-empty last step would look like missing
    // data.
    if (along.scale == Scale::linear && !panel_.same_scale && x.low < x.high) {
      if (!along.low) along.low = x.low;
      if (!along.high) along.high = x.high;
    }
    x_ = map_axis(along, x.low, x.high, 8);
    y_ = map_axis(panel_.y, y.low, y.high, 5);
    if (panel_.same_scale) equalise();
  }

  // Widens the axis that has the finer scale, so that a unit is as long on both.
  void equalise() {
    const double per_x = (x_.high - x_.low) / width_;
    const double per_y = (y_.high - y_.low) / height_;
    Mapping& widened = per_x < per_y ? x_ : y_;
    const double middle = (widened.low + widened.high) / 2;
    const double half = std::max(per_x, per_y) * (per_x < per_y ? width_ : height_) / 2;
    widened.low = middle - half;
    widened.high = middle + half;
  }

  double at_x(double value) const { return left_ + x_.place(value) * width_; }
  double at_y(double value) const { return top_ + (1 - y_.place(value)) * height_; }

  static double step_of(const std::vector<double>& values) {
    double step = INFINITY;
    for (std::size_t i = 1; i < values.size(); ++i) {
      step = std::min(step, values[i] - values[i - 1]);
    }
    return std::isfinite(step) ? step : values.empty() ? 1.0 : std::max(std::abs(values[0]), 1e-9);
  }

  void frame() {
    put("<clipPath id=\"panel-{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" "
        "height=\"{}\"/></clipPath>\n",
        id_, number(left_), number(top_), number(width_), number(height_));
    if (!panel_.title.empty()) {
      put("<text class=\"title\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_), number(top_ - 8),
          escaped(panel_.title));
    }
    const auto x_ticks = ticks(x_.low, x_.high, 8, x_.scale);
    const auto y_ticks = ticks(y_.low, y_.high, 5, y_.scale);
    for (const double value : x_ticks) {
      const std::string x = number(at_x(value));
      put("<path class=\"grid\" d=\"M{} {}V{}\"/>", x, number(top_), number(top_ + height_));
      put("<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n", x,
          number(top_ + height_ + kTick + kTextSize), tick_text(value, step_of(x_ticks), x_.scale));
    }
    std::size_t longest = 0;
    for (const double value : y_ticks) {
      const double y = at_y(value);
      put("<path class=\"grid\" d=\"M{} {}H{}\"/>", number(left_), number(y),
          number(left_ + width_));
      const std::string label = tick_text(value, step_of(y_ticks), y_.scale);
      longest = std::max(longest, label.size());
      put("<text text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_ - kTick - 2),
          number(y + kTextSize * 0.35), label);
    }
    put("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", number(left_),
        number(top_), number(width_), number(height_));
    put("<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_ + width_ / 2),
        number(top_ + height_ + 2 * kTextSize + 10), escaped(axis_title(panel_.x)));
    const double middle = top_ + height_ / 2;
    const double beside = left_ - kTick - 10 - static_cast<double>(longest) * kCharacter;
    put("<text text-anchor=\"middle\" transform=\"rotate(-90 {} {})\" x=\"{}\" "
        "y=\"{}\">{}</text>\n",
        number(beside), number(middle), number(beside), number(middle),
        escaped(axis_title(panel_.y)));
  }

  void bar(const Span& span) {
    const double from = at_x(span.from), to = at_x(span.to);
    const double bottom = top_ + height_ - 2 - span.lane * kLane;
    put("<rect fill=\"{}\" fill-opacity=\"0.75\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
        palette()[static_cast<std::size_t>(span.colour) % palette().size()], number(from),
        number(bottom - kLane + 2), number(std::max(to - from, 0.5)), number(kLane - 2));
  }

  void line_across(const Moment& moment) {
    put("<path class=\"moment\" d=\"M{} {}V{}\"/>\n", number(at_x(moment.at)), number(top_),
        number(top_ + height_));
  }

  void moment_name(const Moment& moment) {
    const double place = x_.place(moment.at);
    if (moment.name.empty() || !(place >= 0 && place <= 1)) return;
    put("<text class=\"small\" transform=\"rotate(-90 {0} {1})\" x=\"{0}\" y=\"{1}\" "
        "text-anchor=\"end\">{2}</text>\n",
        number(at_x(moment.at) - 2), number(top_ + 3), escaped(moment.name));
  }

  void series(std::size_t index) {
    const Series& series = panel_.series[index];
    const auto place =
        static_cast<std::size_t>(series.colour >= 0 ? series.colour : static_cast<int>(index));
    const std::string& colour = palette()[place % palette().size()];
    const std::string faint = series.faint ? " opacity=\"0.4\"" : "";
    if (series.style != SeriesStyle::points) {
      const std::string dash = kDashes[place % std::size(kDashes)];
      put("<path class=\"line\" stroke=\"{}\"{}{} d=\"{}\"/>\n", colour,
          dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dash), faint,
          path_of(series));
    }
    if (series.style != SeriesStyle::line) {
      put("<g fill=\"{}\"{}>\n", colour, faint);
      for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (!x_.shows(series.x[i]) || !y_.shows(series.y[i])) continue;
        put("<circle cx=\"{}\" cy=\"{}\" r=\"2.4\"/>\n", number(at_x(series.x[i])),
            number(at_y(series.y[i])));
      }
      out_ += "</g>\n";
    }
  }

  std::string path_of(const Series& series) const {
    std::string path;
    std::vector<Point> run;
    const auto finish = [&] {
      const std::vector<std::uint8_t> kept = thin(run);
      for (std::size_t i = 0; i < run.size(); ++i) {
        if (kept[i] == 0) continue;
        path += fmt::format("{}{} {}", i == 0 ? "M" : "L", number(run[i].x), number(run[i].y));
      }
      run.clear();
    };
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (x_.shows(series.x[i]) && y_.shows(series.y[i])) {
        run.push_back({at_x(series.x[i]), at_y(series.y[i])});
      } else {
        finish();
      }
    }
    finish();
    return path;
  }

  const Panel& panel_;
  double left_, top_, width_, height_;
  int id_;
  std::string& out_;
  Mapping x_, y_;
};

struct LegendEntry {
  std::string name;
  std::size_t place;
  bool points;
};

std::vector<LegendEntry> legend_of(const Panel& panel) {
  std::vector<LegendEntry> entries;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    if (series.name.empty()) continue;
    entries.push_back({series.name,
                       series.colour >= 0 ? static_cast<std::size_t>(series.colour) : i,
                       series.style == SeriesStyle::points});
  }
  return entries;
}

// Lays the names out in rows of the panel's width; returns the height. `out` null: only measures.
double write_legend(const Panel& panel, double left, double top, double width, std::string* out) {
  const auto entries = legend_of(panel);
  if (entries.empty()) return 0.0;
  double x = 0.0, y = 0.0;
  for (const LegendEntry& entry : entries) {
    // UTF-8 continuation bytes take no room.
    const auto letters = std::count_if(entry.name.begin(), entry.name.end(),
                                       [](char c) { return (c & 0xC0) != 0x80; });
    const double room = 30 + static_cast<double>(letters) * kCharacter + 14;
    if (x > 0 && x + room > width) {
      x = 0;
      y += kTextSize + 5;
    }
    if (out != nullptr) {
      const std::string& colour = palette()[entry.place % palette().size()];
      const double middle = top + y + kTextSize * 0.6;
      if (entry.points) {
        *out += fmt::format("<circle fill=\"{}\" cx=\"{}\" cy=\"{}\" r=\"2.4\"/>", colour,
                            number(left + x + 12), number(middle));
      } else {
        const std::string dash = kDashes[entry.place % std::size(kDashes)];
        *out += fmt::format("<path class=\"line\" stroke=\"{}\"{} d=\"M{} {}h24\"/>", colour,
                            dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dash),
                            number(left + x), number(middle));
      }
      *out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", number(left + x + 30),
                          number(top + y + kTextSize), escaped(entry.name));
    }
    x += room;
  }
  return y + kTextSize + 8;
}

Status check_figure(const Figure& figure) {
  if (figure.panels.empty()) return Error("plot-empty", "a figure needs a panel");
  for (const Panel& panel : figure.panels) {
    for (const Axis* axis : {&panel.x, &panel.y}) {
      if (Status good = check_axis(*axis); !good) return good;
    }
    for (const Series& series : panel.series) {
      if (series.x.size() != series.y.size()) {
        return Error("plot-shape", fmt::format("the series '{}' has {} x and {} y", series.name,
                                               series.x.size(), series.y.size()));
      }
    }
  }
  return {};
}

constexpr const char* kStyle =
    "<style>text{font:12px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#222}"
    ".title{font-size:14px;font-weight:600}.small{font-size:10px;fill:#555}"
    ".grid{stroke:#e2e5e9;stroke-width:1}.frame{fill:none;stroke:#7b8794;stroke-width:1}"
    ".line{fill:none;stroke-width:1.6;stroke-linejoin:round}"
    ".moment{stroke:#555;stroke-width:1;stroke-dasharray:3 3}</style>\n";

}  // namespace

const std::vector<std::string>& palette() {
  // Okabe and Ito, Color Universal Design (2008): told apart by colour-blind people too. Its yellow
  // is left out, for on white paper it cannot be seen; black comes last.
  static const std::vector<std::string> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                   "#e69f00", "#56b4e9", "#000000"};
  return colours;
}

Result<std::string> to_svg(const Figure& figure) {
  if (Status good = check_figure(figure); !good) return good.error();
  constexpr double kLeft = 66, kRight = 16, kTop = 28, kBottom = 48;
  const int columns = std::max(1, std::min(figure.columns, static_cast<int>(figure.panels.size())));
  const double cell_width = kLeft + figure.panel_width + kRight;
  const double head = figure.title.empty() ? 0.0 : kTitleSize + 14;

  std::string body;
  double y = head;
  for (std::size_t first = 0; first < figure.panels.size();) {
    double legend_room = 0;
    const std::size_t end =
        std::min(figure.panels.size(), first + static_cast<std::size_t>(columns));
    for (std::size_t i = first; i < end; ++i) {
      legend_room =
          std::max(legend_room, write_legend(figure.panels[i], 0, 0, figure.panel_width, nullptr));
    }
    for (std::size_t i = first; i < end; ++i) {
      const double left = kLeft + static_cast<double>(i - first) * cell_width;
      const double top = y + kTop;
      PanelWriter(figure.panels[i], left, top, figure.panel_width, figure.panel_height,
                  static_cast<int>(i), body)
          .write();
      write_legend(figure.panels[i], left, top + figure.panel_height + kBottom - 6,
                   figure.panel_width, &body);
    }
    y += kTop + figure.panel_height + kBottom + legend_room;
    first = end;
  }

  const std::string width = number(cell_width * columns);
  const std::string height = number(y);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\" role=\"img\">\n",
      width, height);
  if (!figure.title.empty()) svg += fmt::format("<title>{}</title>\n", escaped(figure.title));
  svg += kStyle;
  svg += fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"#fff\"/>\n", width, height);
  if (!figure.title.empty()) {
    svg +=
        fmt::format("<text class=\"title\" style=\"font-size:16px\" x=\"16\" y=\"22\">{}</text>\n",
                    escaped(figure.title));
  }
  svg += body;
  svg += "</svg>\n";
  return svg;
}

}  // namespace krok::draw
