#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

// Plots as SVG: lines and points over linear or logarithmic axes, several panels a figure. Text
// stays text, so that it can be searched and set in the reader's own typeface; lines differ by dash
// as well as by colour, so that they can be told apart in print. The same figure gives the same
// bytes. Written by the project itself: of the plotting libraries that Debian has for C++, none
// keeps text as text and gives the same bytes on every machine.

namespace krok::draw {

enum class Scale : unsigned char { linear, logarithmic };

struct Axis {
  std::string label;      // what it is, "time"
  std::string unit = {};  // "s"; empty for a number
  Scale scale = Scale::linear;
  std::optional<double> low = {}, high = {};  // otherwise from the data, rounded outwards to ticks
};

enum class SeriesStyle : unsigned char { line, points, line_and_points };

// Points (x[i], y[i]) in order; the line is broken where either is not finite (or not positive on
// a logarithmic axis).
struct Series {
  std::string name;  // for the legend; empty for none
  std::vector<double> x, y;
  SeriesStyle style = SeriesStyle::line;
  int colour = -1;     // place in the palette; -1: the series' own place in the panel
  int dash = -1;       // which stroke pattern, 0 is solid; -1: the colour's own
  bool arrow = false;  // a head at the end of the line, in its direction there
  bool faint = false;
};

// A stretch of the x axis, such as a foot on the ground, drawn as a bar in a lane. Lanes are
// stacked from the axis upwards, below the series.
struct Span {
  double from = 0.0, to = 0.0;
  int lane = 0;
  int colour = 0;
};

// A moment on the x axis with a name, drawn as a line across.
struct Moment {
  double at = 0.0;
  std::string name;
};

// Values over an even grid, as colours below the series: white at zero, towards brown above it and
// towards violet below, with a bar that tells which colour is which value.
struct Field {
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;  // of the grid's outer edges, rising
  int columns = 0, rows = 0;                            // up to 1,000 each
  std::vector<double> values;  // [rows x columns], the row at y_low first; NaN is left blank
};

struct Panel {
  std::string title;
  Axis x, y;
  bool same_scale = false;  // a unit is as long on both axes: maps, paths
  bool legend = true;       // names of series below the panel; false where the figure's tells all
  std::optional<Field> field = {};
  std::vector<Series> series;
  std::vector<Span> spans;
  std::vector<std::string> lanes;  // names beside the lanes, a letter or two, from below
  std::vector<Moment> moments;
};

// What a colour and a stroke pattern stand for.
struct LegendEntry {
  std::string name;
  int colour = 0;  // as in Series, but of the figure's legend never -1
  int dash = -1;
  SeriesStyle style = SeriesStyle::line;
};

struct Chart {
  std::string title;
  std::vector<LegendEntry> legend;  // of all panels, below the title; panels may have their own
  std::vector<Panel> panels;
  int columns = 1;
  double panel_width = 640.0, panel_height = 260.0;  // of the plotted area, CSS pixels
};

// The figure as an SVG text. Lines are thinned to what a fiftieth of a pixel can show. Codes:
// plot-empty for a figure without a panel; plot-shape for series whose x and y differ in length
// and for a field whose values do not fill its grid or whose edges do not rise; plot-size for
// panels under a pixel or over 100,000; plot-axis for limits that are not finite, not rising, or
// not positive on a logarithmic axis.
Result<std::string> to_svg(const Chart& chart);

// The colours that series take in turn, as "#rrggbb".
const std::vector<std::string>& palette();

// Round positions for ticks that cover [low, high]: multiples of 1, 2 or 5 times a power of ten,
// about `wanted` of them; for a logarithmic axis powers of ten, or 1, 2, 5 of each where there are
// few. low < high, both finite, positive if logarithmic.
std::vector<double> ticks(double low, double high, int wanted, Scale scale);

}  // namespace krok::draw
