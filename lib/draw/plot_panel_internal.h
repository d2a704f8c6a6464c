#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "draw/plot.h"
#include "draw/plot_line_internal.h"

// Private to this folder.

namespace krok::draw {

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
