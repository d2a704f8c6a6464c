#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "draw/plot.h"
#include "draw/plot_axis_internal.h"

// Private to this folder: geometry of series.

namespace krok::draw {

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

}  // namespace krok::draw
