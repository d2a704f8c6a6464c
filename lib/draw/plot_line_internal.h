#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "draw/plot.h"
#include "draw/plot_axis_internal.h"

// Private to this folder: the lines of series.

namespace krok::draw {

struct Point {
  double x = 0, y = 0;  // pixels, y down
};

// What lies far outside of given limits is put outside at a distance that every viewer can count
// to.
inline double within_reach(double place) {
  return std::clamp(place, -1e4, 1e4);
}

// The plotted area of a panel: from values to pixels.
struct PlotArea {
  double left = 0, top = 0, width = 1, height = 1;  // of the data, without the lanes of spans
  Mapping x, y;

  double at_x(double value) const { return left + within_reach(x.place(value)) * width; }
  double at_y(double value) const { return top + (1 - within_reach(y.place(value))) * height; }
  bool shows(double at, double value) const { return x.shows(at) && y.shows(value); }
};

// The stretches of a series that can be shown without a break, each thinned to the points that it
// needs to stay within a fiftieth of a pixel of itself.
std::vector<std::vector<Point>> runs_of(const Series& series, const PlotArea& area);

// The points of a series that can be shown, one for each quarter of a pixel.
std::vector<Point> points_of(const Series& series, const PlotArea& area);

// "M1 2L3 4"; a run of one point becomes a dot as wide as the line.
std::string path_of(const std::vector<std::vector<Point>>& runs);

// The corners of a head at the end of the last run, in its direction there; empty where it is too
// short to have one.
std::vector<Point> arrow_head(const std::vector<std::vector<Point>>& runs);

}  // namespace krok::draw
