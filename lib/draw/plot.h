#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

// Plots as SVG: lines and points over linear or logarithmic axes, several panels per chart. Text is
// kept as text, so that it is searchable and uses the reader's own fonts; lines differ by dash
// pattern as well as by colour, for greyscale prints. Output is deterministic, byte for byte, on
// every machine.

namespace krok::draw {

enum class Scale : unsigned char { linear, logarithmic };

struct Axis {
  std::string label;      // quantity, such as "time"
  std::string unit = {};  // "s"; empty for dimensionless values
  Scale scale = Scale::linear;
  std::optional<double> low = {}, high = {};  // default: from the data, rounded outwards to ticks
};

enum class SeriesStyle : unsigned char { line, points, line_and_points };

// Points (x[i], y[i]) in order; the line breaks where either is not finite (or not positive on a
// logarithmic axis).
struct Series {
  std::string name;  // legend entry; empty for none
  std::vector<double> x, y;
  SeriesStyle style = SeriesStyle::line;
  int colour = -1;     // palette index; -1: the index of the series in its panel
  int dash = -1;       // dash pattern, 0 is solid; -1: that of the colour
  bool arrow = false;  // an arrowhead at the end of the line
  bool faint = false;
  bool filled = false;  // the area that the line goes round is tinted
};

// An interval of the x axis, such as a foot contact, drawn as a bar in a lane. Lanes are stacked
// from the axis upwards, below the series.
struct Span {
  double from = 0.0, to = 0.0;
  int lane = 0;
  int colour = 0;
};

// A named position on the x axis, drawn as a vertical line.
struct Moment {
  double at = 0.0;
  std::string name;
};

// A text in the plot area, centred at (x, y).
struct Note {
  double x = 0, y = 0;
  std::string text;
};

// A heatmap on a regular grid, drawn below the series: white at zero, towards brown above and
// towards violet below, with a colour bar.
struct Field {
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;  // outer edges of the grid; low < high
  int columns = 0, rows = 0;                            // at most 1,000 each
  std::vector<double> values;  // [rows x columns], the row at y_low first; NaN is left blank
  bool faint = false;          // paler, below lines that are to be seen
};

struct Panel {
  std::string title;
  Axis x, y;
  bool same_scale = false;  // equal scale on both axes, for maps and paths
  bool legend = true;       // panel legend below the panel; false if the chart's legend covers it
  std::optional<Field> field = {};
  std::vector<Series> contours;  // thin grey lines below the series, of equal heights
  std::vector<Series> series;
  std::vector<Span> spans;
  std::vector<std::string> lanes;  // labels beside the lanes, a letter or two, bottom to top
  std::vector<Moment> moments;
  std::vector<Note> notes;
};

// A legend sample: a name with its colour and dash pattern.
struct LegendEntry {
  std::string name;
  int colour = 0;  // as in Series, but never -1 in the chart's legend
  int dash = -1;
  SeriesStyle style = SeriesStyle::line;
  bool faint = false;
};

struct Chart {
  std::string title;
  std::vector<LegendEntry> legend;  // of all panels, below the title; panels may have their own
  std::vector<Panel> panels;
  int columns = 1;
  double panel_width = 640.0, panel_height = 260.0;  // of the plot area, CSS pixels
};

// The chart as SVG text. Lines are simplified to within 1/50 pixel. Codes: plot-empty for a chart
// without panels; plot-shape for series whose x and y differ in length and for a field whose values
// do not match its grid or whose edges are not increasing; plot-size for panels under 1 or over
// 100,000 pixels; plot-axis for limits that are not finite, not increasing, or not positive on a
// logarithmic axis.
Result<std::string> to_svg(const Chart& chart);

// The default colours of series, in order, as "#rrggbb".
const std::vector<std::string>& palette();

// Round tick positions that cover [low, high]: multiples of 1, 2 or 5 times a power of ten, about
// `wanted` of them; on a logarithmic axis powers of ten, or 1, 2, 5 times each if there are few.
// low < high, both finite, positive if logarithmic.
std::vector<double> ticks(double low, double high, int wanted, Scale scale);

}  // namespace krok::draw
