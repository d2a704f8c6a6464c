#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "draw/plot.h"

// Private to this folder: mapping of values to axis positions, and tick labels.

namespace krok::draw {

// Whether a value can be drawn on such an axis. Values near the limits of double cannot, because
// the length of the axis would overflow.
inline bool can_show(double value, Scale scale) {
  constexpr double kMax = 1e250;
  return std::abs(value) <= kMax && (scale == Scale::linear || value >= 1 / kMax);
}

// Maps values to axis positions in [0, 1].
struct Mapping {
  double low = 0.0, high = 1.0;
  Scale scale = Scale::linear;

  double place(double value) const {
    if (scale == Scale::linear) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
  }
  bool shows(double value) const { return can_show(value, scale); }
};

// The min and max of the values that an axis can show; low > high if there are none.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double value, Scale scale);
  // A valid axis range: widened around a single value or values too close together for double,
  // arbitrary if there are no values.
  Range settled(Scale scale) const;
};

// plot-axis if the limits are not finite, not increasing, or not positive on a logarithmic axis.
Status check_axis(const Axis& axis);

// The given limits, or those of the values, rounded outwards to about `wanted` ticks.
Mapping map_axis(const Axis& axis, const Range& values, int wanted);

// The smallest 1, 2 or 5 times a power of ten of which at most `wanted` fit between low and high;
// low < high.
double tick_step(double low, double high, int wanted);

// The distance between ticks; with fewer than two, a length that tick_text can use.
double step_of(const std::vector<double>& ticks);

// A tick label: as many digits as distinguish it from its neighbours; on a logarithmic axis, from
// its own value.
std::string tick_text(double value, double step, Scale scale);

// "time (s)"; label or unit alone if the other is empty.
std::string axis_title(const Axis& axis);

// Private to this folder: geometry of series.

struct Point {
  double x = 0, y = 0;  // pixels, y down
};

// Clamps positions far outside the limits to coordinates that every SVG viewer can handle.
inline double within_reach(double place) {
  return std::clamp(place, -1e4, 1e4);
}

// The plot area of a panel: maps values to pixels.
struct PlotArea {
  double left = 0, top = 0, width = 1, height = 1;  // of the data, without the lanes of spans
  Mapping x, y;

  double at_x(double value) const { return left + within_reach(x.place(value)) * width; }
  double at_y(double value) const { return top + (1 - within_reach(y.place(value))) * height; }
  bool shows(double at, double value) const { return x.shows(at) && y.shows(value); }
};

// The unbroken parts of a series, each simplified to within 1/50 pixel.
std::vector<std::vector<Point>> runs_of(const Series& series, const PlotArea& area);

// The visible points of a series, at most one per quarter pixel.
std::vector<Point> points_of(const Series& series, const PlotArea& area);

// "M1 2L3 4"; a run of one point becomes a dot of the line's width.
std::string path_of(const std::vector<std::vector<Point>>& runs);

// The corners of an arrowhead at the end of the last run; empty if the run is too short.
std::vector<Point> arrow_head(const std::vector<std::vector<Point>>& runs);

// Private to this folder: heatmaps.

// Code plot-shape.
Status check_field(const Field& field);

// The colour scale of a field: equal steps from `low` to `high`.
struct FieldScale {
  double low = 0, high = 1;
  int steps = 1;
};
FieldScale scale_of(const Field& field);

// Writes the cells as rectangles; neighbours of the same colour are merged.
void write_field(const Field& field, const PlotArea& area, std::string& out);

// Writes a colour bar with the values at its ends; `right` and `bottom` are its edges in pixels.
// Returns its left edge.
double write_field_bar(const Field& field, double right, double bottom, std::string& out);

// Private to this folder.

// Writes one panel of a chart as SVG.
class PanelWriter {
 public:
  // `width` and `height` are those of the plot area; `id` makes its clip path unique.
  PanelWriter(const Panel& panel, double left, double top, double width, double height, int id,
              std::string& out);

  void write();

 private:
  template <typename... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
  }

  void map();
  void equalise();
  void write_x_axis();
  void write_y_axis();
  void write_lanes();
  void bar(const Span& span);
  void line_across(const Moment& moment);
  void moment_names();
  void series(std::size_t index);
  void contour(const Series& line);
  void note(const Note& note);

  double bottom() const { return top_ + height_; }
  double lane_top(int lane) const;

  const Panel& panel_;
  double left_, top_, width_, height_;
  int lanes_ = 0;
  int x_ticks_wanted_, y_ticks_wanted_;
  int id_;
  std::string& out_;
  PlotArea area_;
};

}  // namespace krok::draw
