#include "draw/plot_panel_internal.h"

#include "core/numbers.h"
#include "core/text.h"
#include "draw/chart_style_internal.h"

namespace krok::draw {

namespace {

constexpr double kLane = 10.0;
constexpr double kBetweenNames = 10.0;  // between moment names, so that they do not overlap
constexpr double kAroundArea = 3.0;     // margin, so that marks at the axis limits are not clipped

std::string opacity_of(const Series& series) {
  return series.faint ? " opacity=\"0.4\"" : "";
}

// As many ticks as fit `apart` pixels apart; at least five if they fit `close` pixels apart.
int ticks_wanted(double length, double apart, double close) {
  const int least = std::clamp(static_cast<int>(length / close), 1, 5);
  return std::clamp(static_cast<int>(length / apart), least, 20);
}

// What a pointer over a line shows: its name and range.
std::string hover_text(const Series& series, const Axis& axis) {
  double low = INFINITY, high = -INFINITY;
  for (const double value : series.y) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high)) return series.name;
  return fmt::format("{}: {} to {}{}{}", series.name, readable(low, 4), readable(high, 4),
                     axis.unit.empty() ? "" : " ", axis.unit);
}

}  // namespace

PanelWriter::PanelWriter(const Panel& panel, double left, double top, double width, double height,
                         int id, std::string& out)
    : panel_(panel),
      left_(left),
      top_(top),
      width_(width),
      height_(height),
      x_ticks_wanted_(ticks_wanted(width, 80, 50)),
      y_ticks_wanted_(ticks_wanted(height, 52, 32)),
      id_(id),
      out_(out) {
  lanes_ = static_cast<int>(panel.lanes.size());
  for (const Span& span : panel.spans) lanes_ = std::max(lanes_, span.lane + 1);
  const double lane_room = lanes_ > 0 ? lanes_ * kLane + 4 : 0.0;
  area_ = {left, top, width, std::max(height - lane_room, 1.0), {}, {}};
  map();
}

void PanelWriter::write() {
  put("<clipPath id=\"panel-{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
      id_, number(left_ - kAroundArea), number(top_ - kAroundArea),
      number(width_ + 2 * kAroundArea), number(height_ + 2 * kAroundArea));
  double title_room = width_;
  if (panel_.field) {
    const double bar = write_field_bar(*panel_.field, left_ + width_, top_ - 8, out_);
    title_room = std::max(0.0, bar - left_ - kTick);
  }
  if (!panel_.title.empty()) {
    put("<text class=\"title\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_), number(top_ - 8),
        to_markup(shortened(panel_.title, title_room * kTextSize / kTitleSize)));
  }
  write_x_axis();
  write_y_axis();
  write_lanes();
  put("<g clip-path=\"url(#panel-{})\">\n", id_);
  if (panel_.field) write_field(*panel_.field, area_, out_);
  for (const Span& span : panel_.spans) bar(span);
  for (const Moment& moment : panel_.moments) line_across(moment);
  for (const Series& line : panel_.contours) contour(line);
  for (std::size_t i = 0; i < panel_.series.size(); ++i) series(i);
  for (const Note& text : panel_.notes) note(text);
  out_ += "</g>\n";
  moment_names();
}

void PanelWriter::map() {
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
  if (panel_.field) {
    for (const double edge : {panel_.field->x_low, panel_.field->x_high}) {
      x.add(edge, panel_.x.scale);
    }
    for (const double edge : {panel_.field->y_low, panel_.field->y_high}) {
      y.add(edge, panel_.y.scale);
    }
  }
  Axis along = panel_.x;
  // The time axis and the like fill the panel's width; a partly empty last step would look like
  // missing data.
  if (along.scale == Scale::linear && !panel_.same_scale && x.low < x.high) {
    const Range whole = x.settled(along.scale);
    if (!along.low) along.low = whole.low;
    if (!along.high) along.high = whole.high;
  }
  area_.x = map_axis(along, x, x_ticks_wanted_);
  Axis across = panel_.y;
  // A field fills its panel.
  if (panel_.field && !panel_.same_scale && y.low < y.high) {
    if (!across.low) across.low = y.low;
    if (!across.high) across.high = y.high;
  }
  area_.y = map_axis(across, y, y_ticks_wanted_);
  if (panel_.same_scale) equalise();
}

// Widens the axis with the finer scale, so that both have the same scale.
void PanelWriter::equalise() {
  Mapping& x = area_.x;
  Mapping& y = area_.y;
  const double per_x = (x.high - x.low) / area_.width;
  const double per_y = (y.high - y.low) / area_.height;
  Mapping& widened = per_x < per_y ? x : y;
  const double middle = (widened.low + widened.high) / 2;
  const double half = std::max(per_x, per_y) * (per_x < per_y ? area_.width : area_.height) / 2;
  widened.low = middle - half;
  widened.high = middle + half;
}

void PanelWriter::write_x_axis() {
  const auto marks = ticks(area_.x.low, area_.x.high, x_ticks_wanted_, area_.x.scale);
  for (const double value : marks) {
    const std::string x = number(area_.at_x(value));
    put("<path class=\"grid\" d=\"M{} {}V{}\"/>", x, number(top_), number(bottom()));
    put("<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n", x,
        number(bottom() + kTick + kTextSize), tick_text(value, step_of(marks), area_.x.scale));
  }
}

void PanelWriter::write_y_axis() {
  const auto marks = ticks(area_.y.low, area_.y.high, y_ticks_wanted_, area_.y.scale);
  double widest = 0;
  for (const double value : marks) {
    const double y = area_.at_y(value);
    put("<path class=\"grid\" d=\"M{} {}H{}\"/>", number(left_), number(y), number(left_ + width_));
    const std::string label = tick_text(value, step_of(marks), area_.y.scale);
    widest = std::max(widest, text_width(label));
    put("<text text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_ - kTick - 2),
        number(y + kTextSize * 0.35), label);
  }
  put("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", number(left_),
      number(top_), number(width_), number(height_));
  put("<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n", number(left_ + width_ / 2),
      number(bottom() + 2 * kTextSize + 10), to_markup(shortened(axis_title(panel_.x), width_)));
  const std::string middle = number(top_ + height_ / 2);
  const std::string beside = number(std::max(left_ - kTick - 10 - widest, left_ - 54));
  put("<text text-anchor=\"middle\" transform=\"rotate(-90 {} {})\" x=\"{}\" y=\"{}\">{}</text>\n",
      beside, middle, beside, middle, to_markup(shortened(axis_title(panel_.y), height_ + 40)));
}

double PanelWriter::lane_top(int lane) const {
  return bottom() - 2 - (lane + 1) * kLane + 2;
}

void PanelWriter::write_lanes() {
  if (lanes_ == 0) return;
  put("<path class=\"frame\" d=\"M{} {}H{}\"/>\n", number(left_), number(area_.top + area_.height),
      number(left_ + width_));
  for (std::size_t lane = 0; lane < panel_.lanes.size(); ++lane) {
    put("<text class=\"small\" text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>\n",
        number(left_ - kTick - 2), number(lane_top(static_cast<int>(lane)) + kLane - 1),
        to_markup(panel_.lanes[lane]));
  }
}

void PanelWriter::bar(const Span& span) {
  if (!area_.x.shows(span.from) || !area_.x.shows(span.to)) return;
  const double from = area_.at_x(span.from), to = area_.at_x(span.to);
  put("<rect fill=\"{}\" fill-opacity=\"0.75\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
      palette_colour(static_cast<std::size_t>(span.colour)), number(from),
      number(lane_top(span.lane)), number(std::max(to - from, 0.5)), number(kLane - 2));
}

void PanelWriter::line_across(const Moment& moment) {
  if (!area_.x.shows(moment.at)) return;
  put("<path class=\"moment\" d=\"M{} {}V{}\"/>\n", number(area_.at_x(moment.at)), number(top_),
      number(bottom()));
}

void PanelWriter::moment_names() {
  double last = -INFINITY;
  for (const Moment& moment : panel_.moments) {
    if (!area_.x.shows(moment.at)) continue;
    const double place = area_.x.place(moment.at);
    const double x = area_.at_x(moment.at);
    if (moment.name.empty() || !(place >= 0 && place <= 1)) continue;
    if (std::abs(x - last) < kBetweenNames) continue;
    last = x;
    // To the right of the line, so that the first name does not overlap the axis.
    const bool at_end = x + kBetweenNames > left_ + width_;
    put("<text class=\"small name\" transform=\"rotate(-90 {0} {1})\" x=\"{0}\" y=\"{1}\" "
        "text-anchor=\"end\">{2}</text>\n",
        number(at_end ? x - 2 : x + 9), number(top_ + 3),
        to_markup(shortened(moment.name, height_)));
  }
}

void PanelWriter::contour(const Series& line) {
  put("<path class=\"line\" stroke=\"#777\" style=\"stroke-width:0.6\" d=\"{}\"/>\n",
      path_of(runs_of(line, area_)));
}

void PanelWriter::note(const Note& note) {
  if (!area_.x.shows(note.x) || !area_.y.shows(note.y)) return;
  put("<text class=\"small name\" text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n",
      number(area_.at_x(note.x)), number(area_.at_y(note.y) + 0.3 * kTextSize),
      to_markup(note.text));
}

void PanelWriter::series(std::size_t index) {
  const Series& series = panel_.series[index];
  const auto place =
      static_cast<std::size_t>(series.colour >= 0 ? series.colour : static_cast<int>(index));
  const std::string& colour = palette_colour(place);
  const auto runs = runs_of(series, area_);
  if (series.filled) {
    put("<path fill=\"{}\" fill-opacity=\"0.25\" d=\"{}Z\"/>\n", colour, path_of(runs));
  }
  if (series.style != SeriesStyle::points) {
    const std::string dash = dash_pattern(series.dash, place);
    put("<path class=\"line\" stroke=\"{}\"{}{} d=\"{}\"{}\n", colour,
        dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", dash), opacity_of(series),
        path_of(runs),
        series.name.empty()
            ? "/>"
            : fmt::format("><title>{}</title></path>", to_markup(hover_text(series, panel_.y))));
  }
  if (series.arrow) {
    if (const auto head = arrow_head(runs); !head.empty()) {
      put("<path fill=\"{}\"{} d=\"{}Z\"/>\n", colour, opacity_of(series), path_of({head}));
    }
  }
  if (series.style == SeriesStyle::line) return;
  put("<g fill=\"{}\"{}>\n", colour, opacity_of(series));
  for (const Point& point : points_of(series, area_)) {
    put("<circle cx=\"{}\" cy=\"{}\" r=\"2.4\"/>\n", number(point.x), number(point.y));
  }
  out_ += "</g>\n";
}

}  // namespace krok::draw
